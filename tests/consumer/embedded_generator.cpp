// SPDX-License-Identifier: GPL-2.0-or-later
//
// The generator as a library: from a description to the text of a header.
#include <cstdio>
#include <string>

#include "derive/derive.hpp"
#include "describe/read_model.hpp"
#include "emit/header.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  anholon::DeriveRequest request;
  request.functions = {"kinematics"};
  const auto derivation = anholon::derive(anholon::read_model(argv[1]), request);
  const std::string header = anholon::emit_header(derivation->program);
  std::printf("%zu bytes\n", header.size());
  return header.find("inline void kinematics(") != std::string::npos ? 0 : 1;
}
