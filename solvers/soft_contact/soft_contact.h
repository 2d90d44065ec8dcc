// SPDX-License-Identifier: BSD-3-Clause
// The contact of soft parts of a body with each other: of two organs, of an organ and its bed, or
// of a surface with itself. It is an energy of the gap f_i of each point i of the surface,
//
//   Φ = ½ Σ_i w_i ψ(f_i − o_i) σ(S_i / S₀)
//   f_i = P_i / S_i,   S_i = Σ_j m_ij,   P_i = Σ_j m_ij n_j · r_ij,   r_ij = x_i − x_j
//   m_ij = w_j/ρ_ij² ⟨1 − |r_ij|²/ρ_ij²⟩⁴ s(−n_i · n_j)
//
// over the points j of the other parts, or of the same part too. So f is a smooth signed distance
// (an implicit moving least squares surface: Öztireli, Guennebaud and Gross, Comput. Graph. Forum
// 28, 2009). It is exact where the other side is flat, however its points lie, and negative inside.
// ρ follows from the edges around each face, and ρ_ij is the larger one of the faces of i and j.
// All points of both sides have their share, so that neither side is the master, and forces and
// moments balance to rounding.
//
// s is 0 for normals that do not face each other, and so removes the back of a thin part and the
// surroundings of a point of the same surface. Points of one part that are near each other at rest,
// with the part between them, do not touch either. σ fades what has few points in reach, as at an
// edge. Both are steps of the seventh degree, so that Φ is C³. ψ is the law of contact
// (contact_law.h). o_i is 0 where the rest has a gap of the thickness δ, and f_i − δ where it has
// less: bodies that lie on each other at rest press each other only once they come nearer.
//
// There is no friction. The kernel ends at ρ: parts that have passed through each other by more
// would not feel it. So a state in which a point is more than half of its ρ inside has no finite
// energy, and no step moves two surfaces by more than that towards each other.
#pragma once

#include <list>
#include <memory>
#include <vector>

#include "assembly/energy_term.h"
#include "assembly/scene.h"
#include "soft_contact/contact_neighbours.h"
#include "soft_contact/contact_points.h"

namespace palpate {

class SoftContact final : public EnergyTerm {
 public:
  /// @param scene A scene that check() accepts, whose parts touch each other.
  /// @throws InputError two parts overlap in the mesh by more than the thickness.
  explicit SoftContact(const Scene& scene);
  /// @param most_edge ρ is that of the edges around a face, or of this one where they are longer,
  /// m.
  ///   By default it is the mean edge of the surface.
  SoftContact(const Scene& scene, double most_edge);
  ~SoftContact() override;
  SoftContact(const SoftContact&) = delete;
  SoftContact& operator=(const SoftContact&) = delete;

  double add(const NodalVector& state, NodalVector& force,
             std::vector<double>* values) const override;
  void take_blocks(const NodalVector& state, PairBlocks& blocks) const override;
  [[nodiscard]] std::vector<PointPair> pairs_around(const NodalVector& state) const override;
  [[nodiscard]] double longest_share(const NodalVector& state,
                                     const NodalVector& step) const override;

  /// The largest ρ, m.
  [[nodiscard]] double reach() const;

  /// What a point feels.
  struct AtPoint {
    Index point = 0;
    /// f, m.
    double gap = 0;
    /// −ψ′ σ, Pa.
    double pressure = 0;
    /// S/S₀: below 1, the point sees little of the other side, as beyond its edge, and its gap says
    /// little.
    double seen = 0;
  };
  /// The points that have others in reach, ascending.
  [[nodiscard]] std::vector<AtPoint> points_in_reach(const NodalVector& state) const;

  /// What is drawn and told of a state.
  struct OnSurface {
    /// The pressure at each point of the mesh, averaged over its faces [num_points], Pa.
    std::vector<double> pressure;
    /// The gap, likewise; NaN where little or nothing is in reach [num_points], m.
    std::vector<double> gap;
    /// The force on each part by the others and itself [parts], N.
    std::vector<Vec3> force_on_part;
    /// How deep a point is inside another part, m.
    double deepest = 0;
  };
  [[nodiscard]] OnSurface on_surface(const NodalVector& state) const;

  /// The part of a force that is the error of the layer, to first order in its thickness: with hard
  /// surfaces the force would be smaller by it, N. These would touch at the gap 0, where the layer
  /// lets points press each other at the gap f(p). By the principle of complementary energy, the
  /// energy of the body is larger by ½ Σ w σ ∫ f dp for it.
  /// @param sensitivity ∂u/∂q of the coordinates q of a tool [components × q].
  [[nodiscard]] Eigen::VectorXd layer_force(const NodalVector& state,
                                            const Eigen::MatrixXd& sensitivity) const;

 private:
  /// Sums over the other points.
  struct Sums {
    double s = 0;
    double p = 0;
    [[nodiscard]] double gap() const { return p / s; }
  };
  /// A point's energy, and its derivatives by P and S; 0 where the law does not act.
  struct Jet {
    double value = 0, p = 0, s = 0, pp = 0, ps = 0, ss = 0;
    /// −ψ′ σ, Pa.
    double pressure = 0;
  };
  struct Sight;
  struct Jets;
  struct Coupling;

  /// The points near each other, at a state or one that differs little from it.
  [[nodiscard]] const ContactNeighbours& near(const NodalVector& state) const;
  /// What the points near each other see in a state. It is valid until the next call.
  /// @param around Up to how many ρ: 1, or more.
  [[nodiscard]] Sight& look(const NodalVector& state, double around) const;
  /// Sets the derivatives of the energy by the sums of each point, and by its place and normal.
  /// @returns The energy, J; infinite: a point has passed through a surface.
  [[nodiscard]] double differentiate(Sight& sight) const;
  /// @param further As of acts().
  [[nodiscard]] Coupling couple(const Sight& sight, double further) const;
  /// @param further How far beyond the thickness the law is taken to act, m.
  [[nodiscard]] bool acts(Index point, const Sums& sums, double further) const;
  /// The energy of a point where the law acts.
  [[nodiscard]] Jet energy_of(Index point, const Sums& sums) const;
  /// ½ Σ w σ ∫ f dp, J.
  [[nodiscard]] double layer_energy(const NodalVector& state) const;
  /// Whether a point sees so much of the other side that it may touch it.
  [[nodiscard]] bool is_covered(const Sums& sums) const;
  [[nodiscard]] bool has_passed_through(Index point, const Sums& sums) const;
  /// A share of a step within which no surface passes through another one unnoticed.
  /// @param fastest How far a point moves in the step at the most, m.
  /// @param depths Those of the faces in the state.
  [[nodiscard]] double safe_share(const NodalVector& state, const NodalVector& step, double fastest,
                                  const std::vector<double>& depths) const;
  /// How deep a point of each face of the surface is inside another one, m; 0 if none is.
  [[nodiscard]] std::vector<double> depths_of_faces(const NodalVector& state) const;
  /// How much deeper each face may come before it is too deep, given the depths: the least, m.
  /// @param deepest The largest depth, in ρ.
  [[nodiscard]] double least_left(const std::vector<double>& depths, double deepest) const;
  void set_offsets();

  ContactLaw law_;
  ContactPoints points_;
  TouchRule rule_;
  /// m.
  double least_reach_;
  /// How far beyond ρ neighbours are searched for, m.
  double margin_;
  /// o of each point, m.
  std::vector<double> offsets_;
  /// Of the states that were looked at last, the last one first.
  mutable std::list<ContactNeighbours> neighbours_;
  /// Of the last state that was looked at.
  mutable std::unique_ptr<Sight> sight_;
};

/// The contact of the parts of a scene; null: they do not touch each other.
[[nodiscard]] std::unique_ptr<const SoftContact> make_soft_contact(const Scene& scene);

/// Terms with the contact of the parts, if there is one, before them.
[[nodiscard]] std::vector<const EnergyTerm*> with_contact(
    const SoftContact* contact, const std::vector<const EnergyTerm*>& terms);

}  // namespace palpate
