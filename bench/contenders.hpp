// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Who takes part. Functions are named as the generator names them; a contender that does not know a function
// or a robot is left out. The robot must outlive its contenders.

#include <string>
#include <vector>

#include "emit/statements.hpp"
#include "measure.hpp"
#include "robot.hpp"
#include "tape/interface.hpp"

namespace anholon::bench {

/// Flags of the generated code: those of the program's own compilations, for this processor.
const std::vector<std::string>& generated_flags();

/// Generated code of a program that holds the functions, called through its C interface.
std::vector<Contender> generated_contenders(const Robot& robot, const Program& program,
                                            const std::string& function, const std::string& name,
                                            const StatementStyle& style);
/// prepare() of a program with parameters, which all functions of the program share.
std::vector<Contender> preparation_contenders(const Robot& robot, const Program& program,
                                              const std::string& name, const StatementStyle& style);
/// The project's own recursions in double, without generated code.
std::vector<Contender> recursion_contenders(const Robot& robot, const std::string& function);
/// MuJoCo: kinematics, comPos, comVel, rne; forward without constraints, contacts and passive forces.
std::vector<Contender> mujoco_contenders(const Robot& robot, const std::string& function);
/// Orocos KDL, arms on a fixed base.
std::vector<Contender> kdl_contenders(const Robot& robot, const std::string& function);
std::vector<Contender> dart_contenders(const Robot& robot, const std::string& function);
std::vector<Contender> simbody_contenders(const Robot& robot, const std::string& function);
std::vector<Contender> pinocchio_contenders(const Robot& robot, const std::string& function);
std::vector<Contender> rbdl_contenders(const Robot& robot, const std::string& function);

}  // namespace anholon::bench
