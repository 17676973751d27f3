// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/units.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace anholon::units_test {
namespace {

std::string error(std::string_view text) {
  try {
    read_unit(text);
  } catch (const UnitError& e) {
    return fmt::format("{}: {}; {}", e.offset, e.fact, e.mend);
  }
  return "no error";
}

TEST(Units, AreProductsOfPowers) {
  EXPECT_EQ(read_unit("1"), (Dimension{{0, 0, 0}}));
  EXPECT_EQ(read_unit("rad"), (Dimension{{0, 0, 0}}));
  EXPECT_EQ(read_unit("kg m^2"), (Dimension{{1, 2, 0}}));
  EXPECT_EQ(read_unit("kg*m^2"), (Dimension{{1, 2, 0}}));
  EXPECT_EQ(read_unit("N s/m"), (Dimension{{1, 0, -1}}));
  EXPECT_EQ(read_unit("m/s^2"), (Dimension{{0, 1, -2}}));
  EXPECT_EQ(read_unit("m s^-2"), (Dimension{{0, 1, -2}}));
  EXPECT_EQ(read_unit("N m^2"), (Dimension{{1, 3, -2}}));
  EXPECT_EQ(read_unit("kg/m"), (Dimension{{1, -1, 0}}));
  EXPECT_EQ(read_unit("Pa"), (Dimension{{1, -1, -2}}));
  EXPECT_EQ(read_unit("N m s/rad"), (Dimension{{1, 2, -1}}));
  EXPECT_EQ(read_unit("kg m/s/s"), read_unit("N"));
  EXPECT_EQ(read_unit("J/s"), read_unit("W"));
  EXPECT_EQ(read_unit("1/s"), read_unit("Hz"));
}

TEST(Units, ArePrintedAsTheyAreRead) {
  for (const char* text : {"1", "kg", "kg m^2", "kg m/s^2", "1/s", "m/s", "kg/m/s^2"}) {
    EXPECT_EQ(read_unit(text).text(), text);
    EXPECT_EQ(read_unit(read_unit(text).text()), read_unit(text));
  }
}

TEST(Units, ThatAreNotCoherentAreRefused) {
  EXPECT_EQ(error("mm"),
            "0: 'mm' is not a unit of the coherent SI; give the value in m; numbers are never converted");
  EXPECT_EQ(error("N deg"),
            "2: 'deg' is not a unit of the coherent SI; give the value in rad; numbers are never converted");
}

TEST(Units, SayWhereTheyAreWrong) {
  EXPECT_EQ(error(""), "0: the unit is empty; write \"1\" for a plain number");
  EXPECT_EQ(
      error("kg furlong"),
      "3: 'furlong' is not a unit that is known here; write it with kg, m, s, rad, 1, N, Pa, J, W and Hz");
  EXPECT_EQ(error("m^"), "2: the power of a unit must be an integer; at most 12");
  EXPECT_EQ(error("m^99"), "2: the power of a unit must be an integer; at most 12");
  EXPECT_EQ(error("m^x"), "2: the power of a unit must be an integer; at most 12");
  EXPECT_EQ(error("m/"),
            "2: the unit ends where a unit is expected; write for example \"kg m^2\" or \"N s/m\"");
  EXPECT_EQ(error("m/s kg"), "4: a product behind a slash is ambiguous; write products before the first '/'");
  EXPECT_EQ(error("(m)"), "0: '(' does not begin a unit; write for example \"kg m^2\" or \"N s/m\"");
  EXPECT_EQ(error("\xc2\xb5m"),
            "0: '\\xc2' does not begin a unit; write for example \"kg m^2\" or \"N s/m\"");
}

}  // namespace
}  // namespace anholon::units_test
