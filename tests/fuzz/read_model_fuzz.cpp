// SPDX-License-Identifier: GPL-2.0-or-later
// libFuzzer target: any bytes give a model or a ModelError. Build with clang and -DANHOLON_FUZZ=ON, then
//   ASAN_OPTIONS=detect_leaks=0 read_model_fuzz -max_total_time=600 -timeout=10 CORPUS models/*/
//   tests/describe/bad
// Leaks are not looked for: CLN keeps its own constants until the end.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "describe/read_model.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    anholon::read_model_text({reinterpret_cast<const char*>(data), size}, "fuzz.toml");
  } catch (const anholon::ModelError&) {  // the user's mistake, told
  }
  return 0;
}
