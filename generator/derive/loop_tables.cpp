// SPDX-License-Identifier: GPL-2.0-or-later
#include "derive/loop_tables.hpp"

#include <algorithm>

namespace anholon {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Entry of (eta, r) that each body's joint is; nothing where some joint has none of its own.
std::optional<std::vector<int>> entries_of_joints(const RigidTree<Expr>& tree, int base) {
  std::vector<int> entry(tree.size(), 0);
  std::vector<char> taken(at(tree.mechanism().coordinates), 0);
  for (std::size_t k = 1; k < tree.size(); ++k) {
    const int own = tree.own_coordinate(k);
    if (own < 0 || taken[at(own)] != 0) return std::nullopt;
    taken[at(own)] = 1;
    entry[k] = base + own;
  }
  if (std::ranges::find(taken, 0) != taken.end()) return std::nullopt;
  return entry;
}

/// One behind the subtree of each entry; nothing where a subtree is not in one piece.
std::optional<std::vector<int>> subtree_ends(const std::vector<int>& parent) {
  std::vector<int> end, size(parent.size(), 1);
  for (int k = 0; k < static_cast<int>(parent.size()); ++k) end.push_back(k + 1);
  for (int k = static_cast<int>(parent.size()); k-- > 0;) {
    if (end[at(k)] - k != size[at(k)]) return std::nullopt;
    if (parent[at(k)] < 0) continue;
    end[at(parent[at(k)])] = std::max(end[at(parent[at(k)])], end[at(k)]);
    size[at(parent[at(k)])] += size[at(k)];
  }
  return end;
}

}  // namespace

bool has_loops(const std::string& function) {
  return function == "regressor" || function == "mass_factor" || function == "inverse_mass_matrix";
}

std::optional<TreeLoops> tree_loops(const std::string& function, const RigidTree<Expr>& tree) {
  if (!has_loops(function)) return std::nullopt;
  const auto components = free_components(tree.mechanism().group);
  const int base = static_cast<int>(components.size());
  const auto entry = entries_of_joints(tree, base);
  if (!entry) return std::nullopt;
  TreeLoops loops;
  if (function == "regressor") {
    loops.kind = TreeLoops::Kind::regressor;
    loops.from = regressor_motion;
    for (std::size_t k = 0; k < tree.size(); ++k) loops.parent.push_back(tree.body(k).parent);
    loops.row = *entry;
    loops.component.assign(components.begin(), components.end());
    loops.rows = base + tree.mechanism().coordinates;
    return loops;
  }
  loops.kind =
      function == "mass_factor" ? TreeLoops::Kind::mass_factor : TreeLoops::Kind::inverse_mass_matrix;
  loops.from = "mass_matrix";
  loops.parent.assign(at(base + tree.mechanism().coordinates), 0);
  for (int c = 0; c < base; ++c) loops.parent[at(c)] = c - 1;
  for (std::size_t k = 1; k < tree.size(); ++k) {
    const std::size_t below = tree.parent_of(k);
    const int parent = below > 0 ? (*entry)[below] : base - 1;
    if (parent >= (*entry)[k]) return std::nullopt;
    loops.parent[at((*entry)[k])] = parent;
  }
  const auto end = subtree_ends(loops.parent);
  if (!end) return std::nullopt;
  if (loops.kind == TreeLoops::Kind::inverse_mass_matrix) loops.end = *end;
  return loops;
}

RegressorMotion motion_for_regressor(const RigidTree<Expr>& tree) {
  RegressorMotion result;
  std::vector<Mat3<Expr>> R(tree.size());  // of the joint frames
  std::vector<Vec3<Expr>> p(tree.size());
  const auto append = [](std::vector<Expr>& list, const Vec3<Expr>& v) {
    list.insert(list.end(), {v.x, v.y, v.z});
  };
  for (std::size_t k = 0; k < tree.size(); ++k) {
    const Body<Expr>& body = tree.body(k);
    tree.mechanism().section(body.name + ": place and motion");
    R[k] = Mat3<Expr>::identity();
    Vec3<Expr> linear, angular;
    if (k > 0) {
      const std::size_t below = tree.parent_of(k);
      for (int j = 0; j < 3; ++j) {
        const Vec3<Expr> column = R[below] * tree.joint(k).to_parent(unit<Expr>(j));
        for (int i = 0; i < 3; ++i) R[k](i, j) = column[i];
      }
      p[k] = p[below] + R[below] * tree.joint(k).offset;
      const Vec3<Expr> axis = R[k] * unit<Expr>(body.axis);
      if (body.kind != JointKind::prismatic) angular = axis, linear = cross(p[k], axis);
      if (body.kind == JointKind::prismatic) linear = axis;
      if (body.kind == JointKind::helical) linear += body.pitch * axis;
    }
    append(result.axes, linear);
    append(result.axes, angular);
    const Mat3<Expr> described = R[k] * body.R_frame;
    for (int i = 0; i < 3; ++i) append(result.motion, {described(i, 0), described(i, 1), described(i, 2)});
    append(result.motion, p[k]);
    const RigidTree<Expr>::Motion& m = tree.motion(k);
    const Vec3<Expr> wd = {m.angular_acceleration(0), m.angular_acceleration(1), m.angular_acceleration(2)};
    for (const Vec3<Expr>& v : {m.w, wd, m.a}) append(result.motion, transposed_times(body.R_frame, v));
  }
  return result;
}

}  // namespace anholon
