// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/robot_tree.hpp"

#include <fmt/format.h>

#include <functional>
#include <map>

#include "describe/findings.hpp"
#include "describe/names.hpp"

namespace anholon {
namespace {

using Index = std::map<std::string, int>;

template <class Items>
Index index_of(const Items& items, const char* what, Findings& findings) {
  Index index;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const auto [found, is_new] = index.try_emplace(items[i].name, static_cast<int>(i));
    if (!is_new)
      findings.error(items[i].where, fmt::format("there is a second {} '{}'", what, items[i].name),
                     fmt::format("the first stands in line {}; rename one",
                                 items[static_cast<std::size_t>(found->second)].where.line));
  }
  return index;
}

std::vector<std::string> keys(const Index& index) {
  std::vector<std::string> names;
  for (const auto& [name, i] : index) names.push_back(name);
  return names;
}

}  // namespace

RobotTree robot_tree(const RobotFile& file, const Location& whole_file) {
  Findings findings;
  const Index links = index_of(file.links, "link", findings);
  const Index joints = index_of(file.joints, "joint", findings);
  std::vector<int> carrier(file.links.size(), -1);
  std::vector<std::vector<int>> children(file.links.size());
  for (std::size_t j = 0; j < file.joints.size(); ++j) {
    const RobotJoint& joint = file.joints[j];
    bool known = true;
    for (const auto& [name, where] :
         {std::pair{joint.parent, joint.parent_where}, std::pair{joint.child, joint.child_where}}) {
      if (links.contains(name)) continue;
      known = false;
      findings.error(where, fmt::format("joint '{}' names a link '{}' that does not exist", joint.name, name),
                     did_you_mean(name, keys(links), "write a <link> of this name"));
    }
    if (!known) continue;
    const auto child = static_cast<std::size_t>(links.at(joint.child));
    if (joint.parent == joint.child) {
      findings.error(joint.child_where,
                     fmt::format("joint '{}' joins link '{}' to itself", joint.name, joint.child),
                     "name two links");
    } else if (carrier[child] >= 0) {
      findings.error(joint.child_where,
                     fmt::format("link '{}' is the child of a second joint '{}'", joint.child, joint.name),
                     fmt::format("it is that of '{}' already; loops need a constraint, not a joint",
                                 file.joints[static_cast<std::size_t>(carrier[child])].name));
    } else {
      carrier[child] = static_cast<int>(j);
      children[static_cast<std::size_t>(links.at(joint.parent))].push_back(static_cast<int>(j));
    }
  }
  findings.throw_if_any();

  std::vector<std::string> roots;
  int root = -1;
  for (std::size_t i = 0; i < file.links.size(); ++i) {
    if (carrier[i] >= 0) continue;
    roots.push_back(file.links[i].name);
    if (root < 0) root = static_cast<int>(i);
  }
  if (roots.empty())
    throw ModelError(whole_file, "every link is the child of some joint: the joints form a cycle",
                     "let one link be the root");
  if (roots.size() > 1)
    throw ModelError(file.links[static_cast<std::size_t>(links.at(roots[1]))].where,
                     fmt::format("there are {} root links: {}", roots.size(), listed(roots)),
                     "join them by joints; one link is the root");

  RobotTree tree;
  std::vector<char> reached(file.links.size(), 0);
  const std::function<void(int, int, int)> visit = [&](int link, int joint, int parent) {
    reached[static_cast<std::size_t>(link)] = 1;
    const int self = static_cast<int>(tree.nodes.size());
    tree.nodes.push_back({link, joint, parent});
    for (const int j : children[static_cast<std::size_t>(link)])
      visit(links.at(file.joints[static_cast<std::size_t>(j)].child), j, self);
  };
  visit(root, -1, -1);
  for (std::size_t i = 0; i < file.links.size(); ++i) {
    if (reached[i] == 0)
      throw ModelError(file.links[i].where,
                       fmt::format("link '{}' hangs on a cycle of joints", file.links[i].name),
                       fmt::format("join it to the tree of '{}'", roots[0]));
  }

  for (std::size_t j = 0; j < file.joints.size(); ++j) {
    RobotFollower follower{static_cast<int>(j), 1, 0};
    const RobotJoint* joint = &file.joints[j];
    for (std::size_t steps = 0; joint->mimic && !findings.size(); ++steps) {
      const auto leader = joints.find(joint->mimic->joint);
      const Location& where = joint->mimic->where;
      if (leader == joints.end()) {
        findings.error(where,
                       fmt::format("joint '{}' mimics a joint '{}' that does not exist", joint->name,
                                   joint->mimic->joint),
                       did_you_mean(joint->mimic->joint, keys(joints), "name another joint"));
        break;
      }
      if (steps > file.joints.size()) {
        findings.error(where, fmt::format("joint '{}' mimics itself in the end", joint->name),
                       "let one joint of the circle be free");
        break;
      }
      follower.offset += follower.multiplier * joint->mimic->offset;
      follower.multiplier *= joint->mimic->multiplier;
      follower.leader = leader->second;
      joint = &file.joints[static_cast<std::size_t>(leader->second)];
      if (joint->type != RobotJointType::revolute && joint->type != RobotJointType::continuous &&
          joint->type != RobotJointType::prismatic)
        findings.error(where,
                       fmt::format("joint '{}' mimics '{}', which has no single displacement",
                                   file.joints[j].name, joint->name),
                       "let it mimic a revolute, continuous or prismatic joint");
    }
    tree.followers.push_back(follower);
  }
  findings.throw_if_any();
  return tree;
}

}  // namespace anholon
