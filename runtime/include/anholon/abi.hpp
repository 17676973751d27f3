// SPDX-License-Identifier: MIT
#pragma once

// Flat C interface of generated code. A shared library made of one generated source exports
//
//   const anholon_program* anholon_program_table(void);
//
// and everything else hangs on that table: parameters, functions, names, units and shapes. Arrays are
// row-major and dense, all numbers are double and in coherent SI units. Nothing here allocates or throws; the
// table and all that it points to live as long as the library is loaded.
//
//   1. void* prepared = storage of prepared_size bytes, aligned for any scalar type (malloc will do);
//   2. program->prepare(parameters, prepared), once per set of parameter values;
//   3. function->call(prepared, inputs, outputs): one pointer per block, in the order of the table. Inputs
//      may be outputs too: a function reads all before it writes. Calls may run in parallel.

// NOLINTBEGIN(modernize-*): C reads it too.
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#define ANHOLON_ABI_VERSION 1

/* an array argument of a function */
struct anholon_block {
  const char* name;
  const char* unit;
  const char* meaning;
  int rows;
  int cols;
};

struct anholon_parameter {
  const char* name;
  const char* unit;
  const char* meaning;
  double value; /* default */
};

struct anholon_function {
  const char* name;
  const char* meaning;
  int input_count;
  const struct anholon_block* inputs; /* only those that the function reads */
  int output_count;
  const struct anholon_block* outputs;
  void (*call)(const void* prepared, const double* const* inputs, double* const* outputs);
};

struct anholon_program {
  int abi_version; /* ANHOLON_ABI_VERSION of the writer */
  const char* name_space;
  const char* model;
  const char* scene;
  const char* source_sha256; /* of the description */
  int parameter_count;
  const struct anholon_parameter* parameters;
  size_t prepared_size;
  void (*prepare)(const double* parameters, void* prepared);
  int function_count;
  const struct anholon_function* functions;
};

typedef const struct anholon_program* (*anholon_program_table_function)(void);

#ifdef __cplusplus
}
#endif
// NOLINTEND(modernize-*)
