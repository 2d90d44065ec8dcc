// SPDX-License-Identifier: BSD-3-Clause
// The parts of values that the ranks of a run send each other (schedule/packing.h).
#pragma once

#include "assembly/scene.h"
#include "fields/packed_basis.h"
#include "materials/rheology.h"
#include "schedule/packing.h"
#include "state_space/configuration.h"
#include "state_space/test_point.h"
#include "state_space/tool_space.h"

namespace palpate {

[[nodiscard]] inline bool is_sound(Outcome outcome) {
  return outcome >= Outcome::converged && outcome <= Outcome::tool_inside;
}
[[nodiscard]] inline bool is_sound(History history) {
  return history >= History::flat && history <= History::levels;
}
[[nodiscard]] inline bool is_sound(TestKind kind) {
  return kind >= TestKind::uniform && kind <= TestKind::near_rest;
}
[[nodiscard]] inline bool is_sound(Keep keep) { return keep >= Keep::touch && keep <= Keep::all; }
[[nodiscard]] inline bool is_sound(ElementOrder order) {
  return order == ElementOrder::linear || order == ElementOrder::quadratic;
}
[[nodiscard]] inline bool is_sound(Law law) {
  return law >= Law::linear && static_cast<int>(law) < num_laws;
}
[[nodiscard]] inline bool is_sound(TouchingParts touching) {
  return touching >= TouchingParts::none && touching <= TouchingParts::lips;
}
[[nodiscard]] inline bool is_sound(Formulation formulation) {
  return formulation == Formulation::displacement || formulation == Formulation::mixed;
}
/// Any number is sound, since kinds may be added. tool_kind(), shape_kind() and motion_kind()
/// refuse an unknown one.
[[nodiscard]] inline bool is_sound(InteractionKind /*kind*/) { return true; }
[[nodiscard]] inline bool is_sound(ToolShape /*shape*/) { return true; }
[[nodiscard]] inline bool is_sound(ToolMotion /*motion*/) { return true; }

template <class Visit>
void for_each_part(ConfigurationSummary& c, Visit&& visit) {
  for_each_number_of_summary(c, visit);
  for_each_number_of_mesh_error(c.mesh_error, visit);
  visit(c.of_turns);
  visit(c.reached);
}
template <class Visit>
void for_each_part(IntermediateState& state, Visit&& visit) {
  for_each_number_of_intermediate(state, visit);
}
template <class Visit>
void for_each_part(LevelTransition& transition, Visit&& visit) {
  for_each_number_of_transition(transition, visit);
}
template <class Visit>
void for_each_part(ToolSpaceKey& key, Visit&& visit) {
  visit(key.id);
  visit(key.body);
}
template <class Visit>
void for_each_part(StateKey& key, Visit&& visit) {
  visit(key.tool_space);
  visit(key.check_point);
  visit(key.level);
}
template <class Visit>
void for_each_part(CheckPointBox& box, Visit&& visit) {
  visit(box.first);
  visit(box.last);
}
template <class Visit>
void for_each_part(FieldScale& scale, Visit&& visit) {
  visit(scale.u);
  visit(scale.w);
  visit(scale.p);
  visit(scale.p_w);
}
template <class Visit>
void for_each_part(ContactLaw& law, Visit&& visit) {
  visit(law.thickness);
  visit(law.stiffness);
  visit(law.offset);
}
template <class Visit>
void for_each_part(Grid& grid, Visit&& visit) {
  visit(grid.half_width);
  visit(grid.resolution);
  visit(grid.coarsest);
  visit(grid.origin);
  visit(grid.sparse);
}
template <class Visit>
void for_each_part(ExplorationPolicy& policy, Visit&& visit) {
  visit(policy.force_limit);
  visit(policy.tolerance);
  visit(policy.tolerance_is_relative);
  visit(policy.history);
  visit(policy.intermediate_states);
  visit(policy.third_derivatives);
  visit(policy.depth);
}
template <class Visit>
void for_each_part(Rheology& rheology, Visit&& visit) {
  visit(rheology.density);
  visit(rheology.viscous_time);
  visit(rheology.prony_moduli);
  visit(rheology.prony_times);
}
template <class Visit>
void for_each_part(Material& material, Visit&& visit) {
  visit(material.law);
  visit(material.parameters);
  visit(material.formulation);
}
template <class Visit>
void for_each_part(Configuration& configuration, Visit&& visit) {
  visit(static_cast<ConfigurationSummary&>(configuration));
  for_each_field(configuration, visit);
}
template <class Visit>
void for_each_part(RigidTool& tool, Visit&& visit) {
  visit(tool.shape);
  visit(tool.radius);
  visit(tool.axis);
  visit(tool.length);
  visit(tool.points);
  visit(tool.triangles);
  visit(tool.motion);
  visit(tool.motion_numbers);
  visit(tool.law);
}
template <class Visit>
void for_each_part(InteractionSpec& interaction, Visit&& visit) {
  visit(interaction.kind);
  visit(interaction.material_point);
  visit(interaction.active_node);
  visit(interaction.tip_radius);
  visit(interaction.tool);
}
template <class Visit>
void for_each_part(ToolSpaceSetup& setup, Visit&& visit) {
  visit(setup.id);
  visit(setup.interaction);
  visit(setup.grid);
  visit(setup.policy);
  visit(setup.body);
  bool has_region = setup.region.has_value();
  visit(has_region);
  if (!has_region) {
    setup.region.reset();
    return;
  }
  if (!setup.region) setup.region.emplace();
  for_each_number_of_mesh_region(*setup.region, visit);
}
template <class Visit>
void for_each_part(TestPoint& point, Visit&& visit) {
  for_each_number_of_test_point(point, visit);
  visit(point.displacement);
}

template <class Visit>
void for_each_part(BasisHead& head, Visit&& visit) {
  visit(head.box);
  visit(head.keep);
  visit(head.largest_displacement);
  visit(head.displacement_error);
  visit(head.sensitivity_error);
}
template <class Visit>
void for_each_part(FieldBasis& basis, Visit&& visit) {
  visit(static_cast<BasisHead&>(basis));
  visit(basis.modes);
  visit(basis.pressure_modes);
  visit(basis.steps);
}
template <class Visit>
void for_each_part(PackedBasis& basis, Visit&& visit) {
  visit(static_cast<BasisHead&>(basis));
  visit(basis.num_modes);
  visit(basis.num_pressure_modes);
  visit(basis.num_pressures);
  visit(basis.steps);
  visit(basis.numbers);
}
template <class Visit>
void for_each_part(ReducedFields& fields, Visit&& visit) {
  for_each_field(fields, visit);
}
template <class Visit>
void for_each_part(PackedReduction& reduction, Visit&& visit) {
  visit(reduction.basis);
  visit(reduction.fields);
}
template <class Visit>
void for_each_part(Snapshots& snapshots, Visit&& visit) {
  visit(snapshots.u);
  visit(snapshots.w);
  visit(snapshots.p);
  visit(snapshots.p_w);
}

template <class Visit>
void for_each_part(SettledBody& settled, Visit&& visit) {
  visit(settled.u);
  visit(settled.p);
}
template <class Visit>
void for_each_part(TetMesh& mesh, Visit&& visit) {
  visit(mesh.order);
  visit(mesh.points);
  visit(mesh.cells);
}
template <class Visit>
void for_each_part(Organ& organ, Visit&& visit) {
  visit(organ.materials);
  visit(organ.densities);
  visit(organ.body_force);
  visit(organ.touching);
  visit(organ.contact);
}
template <class Visit>
void for_each_part(Cut& cut, Visit&& visit) {
  visit(cut.faces);
  visit(cut.stage);
  visit(cut.areas);
}
template <class Visit>
void for_each_part(Body& body, Visit&& visit) {
  visit(body.mesh);
  visit(body.material_of_cell);
  visit(body.part_of_cell);
  visit(body.fixed);
  visit(body.touchable);
  visit(body.held_directions);
  visit(body.support_stiffness);
  visit(body.applied_pressure);
  visit(body.applied_traction);
  visit(body.cut);
}
template <class Visit>
void for_each_part(Scene& scene, Visit&& visit) {
  visit(scene.organ);
  visit(scene.body);
}

}  // namespace palpate
