// SPDX-License-Identifier: GPL-2.0-or-later
#include "emit/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "describe/ascii.hpp"

namespace anholon {
namespace {

constexpr std::array keywords = {
    "alignas",     "alignof",  "and",        "and_eq",    "asm",       "auto",         "bitand",
    "bitor",       "bool",     "break",      "case",      "catch",     "char",         "char16_t",
    "char32_t",    "char8_t",  "class",      "co_await",  "co_return", "co_yield",     "compl",
    "concept",     "const",    "const_cast", "consteval", "constexpr", "constinit",    "continue",
    "decltype",    "default",  "delete",     "do",        "double",    "dynamic_cast", "else",
    "enum",        "explicit", "export",     "extern",    "false",     "float",        "for",
    "friend",      "goto",     "if",         "inline",    "int",       "long",         "mutable",
    "namespace",   "new",      "noexcept",   "not",       "not_eq",    "nullptr",      "operator",
    "or",          "or_eq",    "private",    "protected", "public",    "register",     "reinterpret_cast",
    "requires",    "return",   "short",      "signed",    "sizeof",    "static",       "static_assert",
    "static_cast", "struct",   "switch",     "template",  "this",      "thread_local", "throw",
    "true",        "try",      "typedef",    "typeid",    "typename",  "typeof",       "union",
    "unsigned",    "using",    "virtual",    "void",      "volatile",  "wchar_t",      "while",
    "xor",         "xor_eq"};

// what generated code says itself
constexpr std::array own_names = {
    "Parameters", "Prepared", "Real",          "constant",       "detail",   "par",
    "prepare",    "std",      "abs",           "acos",           "asin",     "atan2",
    "cos",        "exp",      "log",           "sign",           "sin",      "sqrt",
    "tan",        "tanh",     "product_error", "quotient_error", "sum_error"};

// macros of <cmath>, of compilers and of the headers that <cmath> may bring along
constexpr std::array macros = {"DOMAIN",
                               "EOF",
                               "FP_INFINITE",
                               "FP_NAN",
                               "FP_NORMAL",
                               "FP_SUBNORMAL",
                               "FP_ZERO",
                               "HUGE",
                               "HUGE_VAL",
                               "HUGE_VALF",
                               "HUGE_VALL",
                               "INFINITY",
                               "MATH_ERREXCEPT",
                               "MATH_ERRNO",
                               "MAXFLOAT",
                               "M_1_PI",
                               "M_2_PI",
                               "M_2_SQRTPI",
                               "M_E",
                               "M_LN10",
                               "M_LN2",
                               "M_LOG10E",
                               "M_LOG2E",
                               "M_PI",
                               "M_PI_2",
                               "M_PI_4",
                               "M_SQRT1_2",
                               "M_SQRT2",
                               "NAN",
                               "NULL",
                               "OVERFLOW",
                               "PLOSS",
                               "SING",
                               "SNAN",
                               "TLOSS",
                               "UNDERFLOW",
                               "X_TLOSS",
                               "assert",
                               "errno",
                               "isfinite",
                               "isinf",
                               "isnan",
                               "isnormal",
                               "linux",
                               "main",
                               "math_errhandling",
                               "signbit",
                               "signgam",
                               "unix"};

// global functions of <cmath>, <cstdlib> and of what programs often include besides: no global namespace may
// be so named
constexpr std::array global_functions = {
    "abort",     "abs",       "accept",    "access", "acct",        "alarm",   "asctime",  "atof",
    "atoi",      "atol",      "bind",      "brk",    "bsearch",     "calloc",  "cbrt",     "ceil",
    "chdir",     "chmod",     "chown",     "chroot", "clock",       "clone",   "close",    "connect",
    "copysign",  "creat",     "crypt",     "ctime",  "daemon",      "div",     "drem",     "dup",
    "encrypt",   "erf",       "erfc",      "exit",   "expm1",       "fabs",    "fdim",     "finite",
    "floor",     "fma",       "fmax",      "fmin",   "fmod",        "fork",    "free",     "frexp",
    "fsync",     "gamma",     "getenv",    "hypot",  "ilogb",       "index",   "ioctl",    "isatty",
    "j0",        "j1",        "jn",        "kill",   "labs",        "ldexp",   "ldiv",     "lgamma",
    "link",      "listen",    "llabs",     "lldiv",  "llrint",      "llround", "lockf",    "log10",
    "log1p",     "log2",      "logb",      "lrint",  "lround",      "lseek",   "malloc",   "memchr",
    "memcmp",    "memcpy",    "memset",    "mktime", "mmap",        "modf",    "mount",    "nan",
    "nanosleep", "nearbyint", "nextafter", "nice",   "open",        "optarg",  "optind",   "opterr",
    "pause",     "pipe",      "poll",      "pow",    "printf",      "profil",  "putenv",   "puts",
    "qsort",     "raise",     "rand",      "random", "read",        "realloc", "realpath", "recv",
    "remainder", "remove",    "remquo",    "rename", "rindex",      "rint",    "rmdir",    "round",
    "scalb",     "scalbln",   "scalbn",    "scanf",  "select",      "send",    "setenv",   "setjmp",
    "longjmp",   "shutdown",  "sigaction", "signal", "significand", "sinh",    "cosh",     "asinh",
    "acosh",     "atanh",     "atan",      "sleep",  "socket",      "sprintf", "srand",    "srandom",
    "stat",      "strcat",    "strchr",    "strcmp", "strcpy",      "strlen",  "swab",     "symlink",
    "sync",      "syscall",   "system",    "tgamma", "time",        "times",   "timezone", "tolower",
    "toupper",   "trunc",     "truncate",  "umask",  "umount",      "uname",   "unlink",   "usleep",
    "utime",     "vfork",     "wait",      "write",  "y0",          "y1",      "yn"};

template <std::size_t n>
bool contains(const std::array<const char*, n>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

}  // namespace

std::string identifier(std::string_view text) {
  std::string name;
  for (const char c : text) {
    const char kept = is_letter(c) || is_digit(c) ? c : '_';
    if (kept == '_' && !name.empty() && name.back() == '_') continue;  // a double underscore is reserved
    name += kept;
  }
  if (name.empty() || !is_letter(name.front()))
    name.insert(0, name.empty() || is_digit(name.front()) ? "x_" : "x");
  if (contains(keywords, name) || contains(own_names, name) || contains(macros, name)) name += '_';
  return name;
}

std::string namespace_identifier(std::string_view text) {
  const std::string name = identifier(text);
  return contains(global_functions, name) ? name + '_' : name;
}

std::string NameScope::claim(std::string_view wish) {
  const std::string name = identifier(wish);
  std::string candidate = name;
  const char* const joint = name.back() == '_' ? "" : "_";
  for (int number = 2; !taken_.insert(candidate).second; ++number)
    candidate = fmt::format("{}{}{}", name, joint, number);
  return candidate;
}

}  // namespace anholon
