// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/modal_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "describe/read_bytes.hpp"
#include "describe/read_parts.hpp"

namespace anholon {
namespace {

using Vector = ModalTable::Vector;
using Tensor = ModalTable::Tensor;
template <class T>
using PerPair = ModalTable::PerPair<T>;

const Exact& rounding() {  // of numbers that a finite-element program prints
  static const Exact value = Exact::from_decimal("1e-6");
  return value;
}

Tensor transpose_of(const Tensor& a) { return {a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]}; }
Vector transpose_of(const Vector& a) { return a; }
Exact transpose_of(const Exact& a) { return a; }

Exact size_of(const Exact& a) { return abs(a); }
template <std::size_t n>
Exact size_of(const std::array<Exact, n>& a) {
  Exact size = 0;
  for (const Exact& x : a) size = std::max(size, abs(x));
  return size;
}
Exact mean(const Exact& a, const Exact& b) { return (a + b) / Exact(2); }
Exact difference(const Exact& a, const Exact& b) { return a - b; }
template <std::size_t n>
std::array<Exact, n> mean(std::array<Exact, n> a, const std::array<Exact, n>& b) {
  for (std::size_t i = 0; i < n; ++i) a[i] = (a[i] + b[i]) / Exact(2);
  return a;
}
template <std::size_t n>
std::array<Exact, n> difference(std::array<Exact, n> a, const std::array<Exact, n>& b) {
  for (std::size_t i = 0; i < n; ++i) a[i] -= b[i];
  return a;
}

}  // namespace

bool is_semidefinite(PerPair<Exact> a) {
  const std::size_t n = a.size();
  std::vector<Exact> scale;
  for (std::size_t i = 0; i < n; ++i) scale.push_back(abs(a[i][i]) * rounding());
  std::vector<char> done(n, 0);
  for (std::size_t step = 0; step < n; ++step) {
    std::size_t p = n;  // the largest pivot left, relative to what it was
    for (std::size_t i = 0; i < n; ++i) {
      if (done[i] == 0 && (p == n || a[i][i] * scale[p] > a[p][p] * scale[i])) p = i;
    }
    done[p] = 1;
    if (a[p][p] < -scale[p]) return false;
    if (a[p][p] <= scale[p]) {  // no mass along it: nothing may couple to it
      for (std::size_t i = 0; i < n; ++i) {
        if (done[i] == 0 && a[i][p] * a[i][p] > scale[p] * abs(a[i][i]) + scale[i] * abs(a[p][p]))
          return false;
      }
      continue;
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (done[i] != 0) continue;
      const Exact factor = (a[i][p] / a[p][p]).as_float();
      for (std::size_t j = 0; j < n; ++j) {
        if (done[j] == 0) a[i][j] -= factor * a[p][j];
      }
    }
  }
  return true;
}

namespace {

class TableOfModes {
 public:
  TableOfModes(const Value& document, Findings& findings)
      : findings_(findings), root_(document, "the table of modes", findings) {}

  ModalTable run() {
    const std::size_t before = findings_.size();
    if (root_.required("anholon_modes", "write anholon_modes = 1, the version of this layout") != nullptr)
      root_.optional_integer("anholon_modes", 1, 1);
    root_.optional_string("title");
    if (const Value* S = root_.required("S", Value::Kind::array, "write one vector for each mode"))
      n_ = S->items.size();
    if (n_ == 0 || n_ > 60) {
      findings_.error(root_.find_where("S"), fmt::format("the table has {} modes", n_), "write 1 to 60");
      root_.accept_all_keys();
      return table_;
    }
    read("mass", true, table_.mass);
    read("first_moment", true, table_.first_moment);
    read("inertia", true, table_.inertia);
    read("S", true, table_.S);
    read("X_phi", true, table_.X_phi);
    read("phi_phi", true, table_.phi_phi);
    read("psi", false, table_.psi);
    read("X_psi", false, table_.X_psi);
    read("stiffness", true, table_.stiffness);
    read("damping", false, table_.damping);
    for (const Value* item : tables_of(root_, "station", findings_)) read_station(*item);
    root_.report_unknown_keys();
    if (findings_.size() == before) check();
    return table_;
  }

 private:
  // One reader for every shape: a number, an array of a fixed size, one entry for each mode.
  bool read(const Value& value, const std::string& what, Exact& number) {
    const auto x = decimal_value(value);
    if (!x || value.kind != Value::Kind::number) {
      findings_.error(value.where, fmt::format("an entry of {} is {}", what, value.kind_name()),
                      "write a decimal number");
      return false;
    }
    number = *x;
    return true;
  }
  bool has_items(const Value& value, const std::string& what, std::size_t count) {
    if (value.kind == Value::Kind::array && value.items.size() == count) return true;
    findings_.error(
        value.where,
        fmt::format("{} has {} where {} belong", what,
                    value.kind == Value::Kind::array ? fmt::format("{} entries", value.items.size())
                                                     : std::string(value.kind_name()),
                    count),
        fmt::format("write an array of {}; there are {} modes", count, n_));
    return false;
  }
  bool read(const Value& value, const std::string& what, Vector& v) {
    if (!has_items(value, what, 3)) return false;
    for (std::size_t i = 0; i < 3; ++i) {
      if (!read(value.items[i], what, v[i])) return false;
    }
    return true;
  }
  bool read(const Value& value, const std::string& what, Tensor& t) {  // three rows
    if (!has_items(value, what, 3)) return false;
    for (std::size_t i = 0; i < 3; ++i) {
      Vector row{};
      if (!read(value.items[i], what, row)) return false;
      for (std::size_t j = 0; j < 3; ++j) t[3 * i + j] = row[j];
    }
    return true;
  }
  template <class T>
  bool read(const Value& value, const std::string& what, std::vector<T>& list) {
    if (!has_items(value, what, n_)) return false;
    list.assign(n_, T{});
    for (std::size_t i = 0; i < n_; ++i) {
      if (!read(value.items[i], what, list[i])) return false;
    }
    return true;
  }
  template <class T>
  void read(std::string_view key, bool required, T& to) {
    const Value* value = required ? root_.required(key, fmt::format("write '{}'", key)) : root_.optional(key);
    if (value != nullptr) read(*value, fmt::format("'{}'", key), to);
  }

  void read_station(const Value& item) {
    TableReader table(item, "a station of the table", findings_);
    ModalTable::Station station;
    station.name = table.required_string("name", "name it: name = \"tip\"").value_or("");
    const auto entry = [&](std::string_view key, bool required, auto& to) {
      const Value* value =
          required ? table.required(key, fmt::format("write '{}'", key)) : table.optional(key);
      if (value != nullptr) read(*value, fmt::format("'{}' of station '{}'", key, station.name), to);
    };
    entry("at", true, station.at);
    entry("phi", true, station.phi);
    entry("turn", true, station.turn);
    entry("psi", false, station.psi);
    table.report_unknown_keys();
    for (const auto& other : table_.stations) {
      if (other.name == station.name)
        findings_.error(item.where, fmt::format("there are two stations '{}'", station.name), "rename one");
    }
    table_.stations.push_back(std::move(station));
  }

  /// Takes the mean of both halves, which have to agree.
  template <class T>
  void symmetrise(PerPair<T>& a, std::string_view key) {
    Exact largest = 0, worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        const T other = transpose_of(a[j][i]);
        largest = std::max({largest, size_of(a[i][j]), size_of(other)});
        worst = std::max(worst, size_of(difference(a[i][j], other)));
        a[i][j] = mean(a[i][j], other);
        a[j][i] = transpose_of(a[i][j]);
      }
    }
    if (worst > rounding() * largest)
      findings_.error(root_.find_where(key),
                      fmt::format("'{}' is not symmetric: entries differ by {}", key, worst.decimal(3)),
                      "entries of modes j and l are those of l and j, transposed");
  }

  void check() {
    symmetrise(table_.phi_phi, "phi_phi");
    symmetrise(table_.psi, "psi");
    symmetrise(table_.X_psi, "X_psi");
    symmetrise(table_.stiffness, "stiffness");
    symmetrise(table_.damping, "damping");
    PerPair<Exact> I(3, std::vector<Exact>(3));
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) I[i][j] = table_.inertia[3 * i + j];
    }
    symmetrise(I, "inertia");
    const auto require = [&](const PerPair<Exact>& a, std::string_view key, std::string_view what) {
      if (!is_semidefinite(a))
        findings_.error(root_.find_where(key), fmt::format("{} is not positive semidefinite", what),
                        "check signs, units and the origin that the integrals refer to");
    };
    require(table_.stiffness, "stiffness", "the stiffness");
    require(table_.damping, "damping", "the damping");
    require(mass_matrix(I), "phi_phi", "the mass matrix of body and modes");
    if (table_.psi.empty() != table_.X_psi.empty())
      findings_.error(root_.find_where(table_.psi.empty() ? "X_psi" : "psi"),
                      "the table has only one of 'psi' and 'X_psi'", "the foreshortening needs both");
  }

  /// Of the undeformed body, in (V, Omega, r_dot).
  [[nodiscard]] PerPair<Exact> mass_matrix(const PerPair<Exact>& I) const {
    PerPair<Exact> M(6 + n_, std::vector<Exact>(6 + n_, 0));
    const Vector& s = table_.first_moment;
    const std::array<std::array<Exact, 3>, 3> cross = {
        {{0, s[2], -s[1]}, {-s[2], 0, s[0]}, {s[1], -s[0], 0}}};
    for (std::size_t i = 0; i < 3; ++i) {
      M[i][i] = table_.mass;
      for (std::size_t j = 0; j < 3; ++j) {
        M[3 + i][3 + j] = I[i][j];
        M[i][3 + j] = M[3 + j][i] = cross[i][j];  // -m s^
      }
    }
    for (std::size_t k = 0; k < n_; ++k) {
      const Tensor& x = table_.X_phi[k];
      const Vector C = {x[5] - x[7], x[6] - x[2], x[1] - x[3]};
      for (std::size_t i = 0; i < 3; ++i) {
        M[i][6 + k] = M[6 + k][i] = table_.S[k][i];
        M[3 + i][6 + k] = M[6 + k][3 + i] = C[i];
      }
      for (std::size_t l = 0; l < n_; ++l) {
        const Tensor& overlap = table_.phi_phi[k][l];
        M[6 + k][6 + l] = overlap[0] + overlap[4] + overlap[8];
      }
    }
    return M;
  }

  Findings& findings_;
  TableReader root_;
  std::size_t n_ = 0;
  ModalTable table_;
};

}  // namespace

ModalTable read_modal_table(const std::filesystem::path& file, const Location& named_at, Findings& findings) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    findings.error(named_at, fmt::format("there is no file '{}'", file.filename().string()),
                   "name the table, relative to the description");
    return {};
  }
  const Value document = read_document(read_bytes(file), file.string());
  return TableOfModes(document, findings).run();
}

}  // namespace anholon
