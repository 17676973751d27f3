// SPDX-License-Identifier: GPL-2.0-or-later
// Errors of several files in one reading.
#include "describe/findings.hpp"

#include <gtest/gtest.h>

#include <string>

namespace anholon::findings_test {
namespace {

TEST(Findings, KeepOneErrorAPlaceOfEachFile) {
  Findings findings;
  findings.error({"model.toml", 3, 1}, "one", "mend it");
  findings.error({"model.toml", 3, 1}, "what follows from it", "mend it");
  findings.error({"beam.toml", 3, 1}, "another file's", "mend it");
  EXPECT_EQ(findings.size(), 2U);
  try {
    findings.throw_if_any();
    FAIL();
  } catch (const ModelError& error) {
    EXPECT_EQ(std::string(error.what()),
              "beam.toml:3:1: error: another file's; mend it\nmodel.toml:3:1: error: one; mend it");
  }
}

}  // namespace
}  // namespace anholon::findings_test
