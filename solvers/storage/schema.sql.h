// SPDX-License-Identifier: BSD-3-Clause
// The tables of a state-space file, see storage/state_space_file.h.
//
// Files of versions 5 to 9 are read too, see versions.h. In version 9 each mode of a basis has a
// row of its own, in a table "mode". Files of earlier versions have no reduced fields, and so
// neither "basis" nor "mode". In versions 5 and 6 a table "site" stands in place of "tool_space".
// The other tables refer to it by the active node, which was the number of a tool space then, and
// its checksum takes in the columns from active_node on. In version 5 a scene and a tool space have
// no checksum, summary_checksum does not take in the column checksum, and it takes in the flags
// without bit 4, as the checksum of an intermediate state does.
//
// The checksums of a body that is not the first take in scene_id before all else.
#pragma once

namespace palpate::storage {

// Columns of floating-point numbers have no type: with the type REAL, SQLite would store -0 as 0.
// The key of a configuration has no column that SQLite makes up, so that files of different ranks
// can be merged row by row.
inline constexpr char kSchema[] = R"sql(
CREATE TABLE scene (
  scene_id         INTEGER PRIMARY KEY,
  parent_scene_id  INTEGER,           -- the scene before its topology changed; NULL: none
  hash             TEXT NOT NULL,     -- of mesh, materials and fixed points, hexadecimal
  solver_tolerance,                   -- of the equilibria, relative
  element_order    INTEGER NOT NULL,  -- 1: 4 nodes a tetrahedron, 2: 10
  num_points       INTEGER NOT NULL,
  num_cells        INTEGER NOT NULL,
  points           BLOB NOT NULL,     -- float64 [num_points x 3], rest position, m
  cells            BLOB NOT NULL,     -- int32 [num_cells x 4 or 10], nodes as in VTK
  material_of_cell BLOB,              -- int32 [num_cells]; NULL: material 0 throughout
  fixed            BLOB NOT NULL,     -- uint8 [num_points], 1: u = 0
  touchable        BLOB NOT NULL,     -- uint8 [num_points], 1: may be touched
  checksum         INTEGER            -- XXH3 (64 bit) of the bytes of touchable, seeded with that
                                      -- of solver_tolerance; the hash takes in all else
);
CREATE TABLE material (
  scene_id    INTEGER NOT NULL REFERENCES scene,
  material    INTEGER NOT NULL,       -- index, from 0
  law         INTEGER NOT NULL,       -- 0 linear, 1 St. Venant-Kirchhoff, 2 neo-Hookean,
                                      -- 3 Mooney-Rivlin, 4 Mooney-Rivlin polynomial, 5 Fung,
                                      -- 6 neo-Hookean incompressible, 7 Mooney-Rivlin
                                      -- incompressible, 8 Ogden
  formulation INTEGER NOT NULL,       -- 0 displacement, 1 mixed, 2 mixed with a fine rule
  -- Moduli in Pa; those that a law does not have are 0.
  --   laws 0 to 2: Young's modulus, Poisson's ratio
  --   law 3: C10, C01, kappa
  --   law 4: kappa, C10, C01, C20, C11, C02, C30, C21, C12, C03
  --   law 5: Young's modulus, Poisson's ratio, exponent
  --   law 6: Young's modulus
  --   law 7: C10, C01
  --   law 8: kappa, mu_1, alpha_1, mu_2, alpha_2, mu_3, alpha_3
  parameter_0, parameter_1, parameter_2, parameter_3, parameter_4,
  parameter_5, parameter_6, parameter_7, parameter_8, parameter_9,
  PRIMARY KEY (scene_id, material)
);
CREATE TABLE tool_space (             -- a tool, the grid of its coordinates, how that is explored
  scene_id    INTEGER NOT NULL REFERENCES scene,
  tool_space_id INTEGER NOT NULL,
  interaction INTEGER NOT NULL,       -- 0: the tool is bonded to a patch, 1: it is rigid and presses
  material_point BLOB NOT NULL,       -- float64 [3], the point of the surface, at rest, m
  active_node INTEGER NOT NULL,       -- the point of the mesh that is there, from 0
  tip_radius,                         -- the surface within it moves with the node, m; 0: it alone
  half_width,                         -- of the box of check-points, m
  resolution  INTEGER NOT NULL,       -- check-points along an axis
  force_limit,                        -- N; 0: none
  coarsest    INTEGER NOT NULL,       -- side of the coarsest cells, in steps of the grid
  tolerance,                          -- error of the force that was asked for; 0: uniform grid
  tolerance_is_relative INTEGER NOT NULL,  -- 1: a share of the largest force, 0: N
  history     INTEGER NOT NULL,       -- 0 flat, 1 levels where there are signs of them, 2 levels
  intermediate_states INTEGER NOT NULL,  -- on the way to each configuration
  third_derivatives INTEGER NOT NULL, -- 1: configurations have their third derivative
  complete    INTEGER NOT NULL,       -- 1: nothing is left to find
  -- Of a rigid tool; 0 or NULL for one that is bonded.
  tool_shape  INTEGER NOT NULL,       -- 0 sphere, 1 capsule, 2 closed surface
  tool_radius,                        -- m
  tool_axis   BLOB NOT NULL,          -- float64 [3], along a capsule
  tool_length,                        -- of its segment, m
  tool_points BLOB,                   -- float64 [points x 3], about the tool's centre, m
  tool_triangles BLOB,                -- int32 [triangles x 3]
  contact_thickness,                  -- of the layer in which it presses, m
  contact_stiffness,                  -- the pressure where tool and body meet, Pa
  origin      BLOB NOT NULL,          -- float64 [3], coordinates of the tool at check-point 0 0 0, m
  sparse      INTEGER NOT NULL,       -- 1: there are cells only where configurations are
  depth,                              -- how deep it presses, m; 0: to the force limit
  checksum    INTEGER NOT NULL,       -- XXH3 (64 bit) of the columns from tool_space_id to depth,
                                      -- 8 bytes each; of a BLOB that has no fixed size that number
                                      -- and the XXH3 of its bytes
  PRIMARY KEY (scene_id, tool_space_id)
);
CREATE TABLE configuration (
  scene_id    INTEGER NOT NULL REFERENCES scene,
  tool_space_id INTEGER NOT NULL,
  i INTEGER NOT NULL, j INTEGER NOT NULL, k INTEGER NOT NULL,  -- check-point; 0 0 0 is rest
  level       INTEGER NOT NULL,       -- which of the equilibria at this check-point; below 0: a
                                      -- run was killed before it was told apart from the others
  parent_i INTEGER, parent_j INTEGER, parent_k INTEGER, parent_level INTEGER,  -- where the
                                                                               -- transition began
  t_x, t_y, t_z,                      -- coordinates of the tool, m: its displacement, or where a rigid one is
  energy,                             -- J
  force_x, force_y, force_z,          -- that holds the tool, N
  stiffness_xx, stiffness_xy, stiffness_xz,                    -- d force / d t, N/m
  stiffness_yx, stiffness_yy, stiffness_yz,
  stiffness_zx, stiffness_zy, stiffness_zz,
  outcome     INTEGER NOT NULL,       -- 0 converged, 1 not converged, 2 tangent could not be
                                      -- factorised, 3 budget used up, 4 aborted, 5 invalid scene,
                                      -- 6 tangent could not be solved for without a factor,
                                      -- 7 tool inside the body
  flags       INTEGER NOT NULL,       -- bits: 1 inverted, 2 unstable, 4 beyond the force limit,
                                      -- 8 near a fold, 16 inertia not computed, 32 inaccurate,
                                      -- 64 touches nothing
  residual,                           -- over the force scale of the scene
  minimum_det_f,
  negative_pivots INTEGER NOT NULL,
  iterations  INTEGER NOT NULL,
  seconds,
  signature_x, signature_y, signature_z,  -- sum over the points of +-u / sqrt(num_points), the signs
                                      -- at random, m: tells levels apart
  third_derivative BLOB,              -- float64 [10], d stiffness / d t: xxx xxy xxz xyy xyz xzz
                                      -- yyy yyz yzz zzz, N/m2; NULL: not computed
  summary_checksum INTEGER NOT NULL,  -- XXH3 (64 bit) of tool_space_id and of the columns from i to
                                      -- signature_z, 8 bytes each, NaN as -1; then of
                                      -- third_derivative, where there is one, and of checksum
  checksum    INTEGER NOT NULL,       -- XXH3 (64 bit) of the bytes of u, then with it as the seed
                                      -- that of v, and so on for p and p_v
  -- The fields: NULL where the transition failed, and where a rigid tool touches nothing. Of a
  -- rigid tool they are of single precision, float32. In a finished space they may be reduced to
  -- coefficients of the modes of the basis in whose box the check-point lies, float32: then u has
  -- [up to num_modes] of them, v [3 x as many], p [up to num_pressure_modes], p_v [3 x as many].
  u           BLOB,                   -- float64 [num_points x 3], displacement, m
  v           BLOB,                   -- float64 [3 x num_points x 3], du/dt_x, du/dt_y, du/dt_z
  p           BLOB,                   -- float64 [num_pressures], of mixed cells, Pa; NULL also where
                                      -- no material is mixed
  p_v         BLOB,                   -- float64 [3 x num_pressures], dp/dt_x, dp/dt_y, dp/dt_z
  PRIMARY KEY (scene_id, tool_space_id, i, j, k, level)
);
CREATE TABLE basis (                  -- of the fields of some configurations, in a finished space
  scene_id    INTEGER NOT NULL REFERENCES scene,
  tool_space_id INTEGER NOT NULL,
  number      INTEGER NOT NULL,       -- among those of the tool space, from 0
  first_i INTEGER NOT NULL, first_j INTEGER NOT NULL, first_k INTEGER NOT NULL,  -- the box of the
  last_i INTEGER NOT NULL, last_j INTEGER NOT NULL, last_k INTEGER NOT NULL,     -- check-points
  keep        INTEGER NOT NULL,       -- points: 0 those of the surface, 1 those of the cells that
                                      -- have one there; first those of the surface, ascending, then
                                      -- the others, ascending
  num_modes   INTEGER NOT NULL,
  num_pressure_modes INTEGER NOT NULL,
  num_pressures INTEGER NOT NULL,     -- that are kept
  largest_displacement,               -- of a point that is kept, m
  displacement_error,                 -- that the modes make, at any of these points, m
  sensitivity_error,                  -- the same of the spacing times du/dt, m
  modes_checksum INTEGER NOT NULL,    -- XXH3 (64 bit) of the bytes of steps, then with it as the
                                      -- seed that of modes
  checksum    INTEGER NOT NULL,       -- XXH3 (64 bit) of the columns from tool_space_id to
                                      -- modes_checksum, 8 bytes each
  steps       BLOB NOT NULL,          -- float32 [num_modes + num_pressure_modes]: the numbers of a
                                      -- mode are multiples of its step; 0: they are any numbers
  -- int32 [num_modes x points kept x 3], then [num_pressure_modes x num_pressures]: n steps, as 2 n
  -- or -2 n - 1 where n is negative; where the step is 0, the number itself, float32. The lowest
  -- bytes of all, then the next ones, deflated by zlib.
  modes       BLOB NOT NULL,
  PRIMARY KEY (scene_id, tool_space_id, number)
);
CREATE TABLE transition (             -- between neighbours, where history matters
  scene_id    INTEGER NOT NULL REFERENCES scene,
  tool_space_id INTEGER NOT NULL,
  i INTEGER NOT NULL, j INTEGER NOT NULL, k INTEGER NOT NULL, level INTEGER NOT NULL,  -- from
  to_i INTEGER NOT NULL, to_j INTEGER NOT NULL, to_k INTEGER NOT NULL,
  reached     INTEGER NOT NULL,       -- level; -1: it failed, -3: one too many
  checksum    INTEGER NOT NULL,       -- XXH3 (64 bit) of the columns from tool_space_id to reached, 8
                                      -- bytes each
  PRIMARY KEY (scene_id, tool_space_id, i, j, k, level, to_i, to_j, to_k)
);
CREATE TABLE intermediate (           -- equilibria on the way to a configuration of level 0
  scene_id    INTEGER NOT NULL REFERENCES scene,
  tool_space_id INTEGER NOT NULL,
  i INTEGER NOT NULL, j INTEGER NOT NULL, k INTEGER NOT NULL,  -- check-point of the configuration
  number      INTEGER NOT NULL,       -- along the straight way from its parent, from 1
  t_x, t_y, t_z,                      -- coordinates of the tool, m: its displacement
  energy,                             -- J
  force_x, force_y, force_z,          -- that holds the tool, N
  outcome     INTEGER NOT NULL,       -- as those of a configuration
  flags       INTEGER NOT NULL,
  seconds,
  checksum    INTEGER NOT NULL,       -- XXH3 (64 bit) of tool_space_id and of the columns from i to
                                      -- seconds, 8 bytes each, NaN as -1
  PRIMARY KEY (scene_id, tool_space_id, i, j, k, number)
);
CREATE TABLE test_point (             -- equilibria by which interpolation is measured
  scene_id    INTEGER NOT NULL REFERENCES scene,
  tool_space_id INTEGER NOT NULL,
  tip_radius  NOT NULL,               -- m
  half_width  NOT NULL,               -- of the box they were drawn in, m
  seed        INTEGER NOT NULL,       -- of the random numbers
  kind        INTEGER NOT NULL,       -- 0 anywhere in the box, 1 on a walk, 2 near rest
  number      INTEGER NOT NULL,       -- among those of its kind, from 0
  t_x, t_y, t_z,                      -- coordinates of the tool, m: its displacement
  energy,                             -- J
  force_x, force_y, force_z,          -- that holds the tool, N
  stiffness_xx, stiffness_xy, stiffness_xz,                    -- d force / d t, N/m
  stiffness_yx, stiffness_yy, stiffness_yz,
  stiffness_zx, stiffness_zy, stiffness_zz,
  outcome     INTEGER NOT NULL,       -- as those of a configuration
  flags       INTEGER NOT NULL,
  seconds,
  checksum    INTEGER NOT NULL,       -- XXH3 (64 bit) of the bytes of displacement, seeded with that
                                      -- of tool_space_id, seed, tip_radius, half_width and of the
                                      -- columns from kind to seconds, 8 bytes each, NaN as -1
  displacement BLOB,                  -- float32 [up to 64 points of the surface x 3], m; NULL where
                                      -- it did not converge
  PRIMARY KEY (scene_id, tool_space_id, tip_radius, half_width, seed, kind, number)
);
)sql";

// The table of the body force is made with the file of a scene that has one. The displacement and
// the pressures of a configuration that are stored as a whole include those of the body at rest;
// fields by modes count from the body at rest.
inline constexpr char kBodyForceSchema[] = R"sql(
CREATE TABLE body_force (
  scene_id     INTEGER PRIMARY KEY REFERENCES scene,
  acceleration BLOB NOT NULL,         -- float64 [3], m/s2
  densities    BLOB NOT NULL,         -- float64 [materials], kg/m3
  displacement BLOB NOT NULL,         -- float64 [num_points x 3], of the body at rest under it, m
  pressures    BLOB,                  -- float64 [num_pressures], at rest under it, Pa; NULL: none
  checksum     INTEGER NOT NULL       -- XXH3 (64 bit) of the bytes of displacement, seeded with that
                                      -- of pressures; the hash of the scene takes in the rest
);
)sql";

// The table of what holds and loads the surface is made with the file of a scene that has such.
// Under a load without a body force the body at rest is in it: fields are as with a body force.
inline constexpr char kBoundarySchema[] = R"sql(
CREATE TABLE boundary_array (
  scene_id INTEGER NOT NULL REFERENCES scene,
  name     TEXT NOT NULL,             -- HeldDirection [num_points x 6: two directions, orthonormal
                                      -- or 0], SupportStiffness [num_points], N/m3,
                                      -- AppliedPressure [num_points], Pa, AppliedTraction
                                      -- [num_points x 3], Pa; those that the scene has.
                                      -- RestDisplacement [num_points x 3], m, and RestPressure
                                      -- [num_pressures], Pa: of the body at rest
  checksum INTEGER NOT NULL,          -- XXH3 (64 bit) of the bytes of numbers, seeded with that of
                                      -- name
  numbers  BLOB,                      -- float64; NULL: none
  PRIMARY KEY (scene_id, name)
);
)sql";

// The table of contact is made with the file of a scene whose parts touch each other.
inline constexpr char kBodyContactSchema[] = R"sql(
CREATE TABLE body_contact (
  scene_id     INTEGER PRIMARY KEY REFERENCES scene,
  touching     INTEGER NOT NULL,      -- 1: each part touches the others, 2: itself too, 3: the
                                      -- sides of a cut each other
  thickness    NOT NULL,              -- of the layer in which they press each other, m
  stiffness    NOT NULL,              -- the pressure at the end of the layer, Pa
  part_of_cell BLOB                   -- int32 [num_cells]; NULL: there is one part. The hash of the
                                      -- scene takes in all of this
);
)sql";

// The table of cuts is made with the file of a scene that has one.
inline constexpr char kBodyCutSchema[] = R"sql(
CREATE TABLE body_cut (
  scene_id INTEGER PRIMARY KEY REFERENCES scene,
  stage    INTEGER NOT NULL,          -- up to which the cut is open
  areas    BLOB NOT NULL,             -- float64 [stages + 1], of the sheet that is open at each
                                      -- stage, from 0 on, m2
  faces    BLOB NOT NULL,             -- int32 [num_cells x 4], the stage at which the face opposite
                                      -- to each corner opens; 0: never
  checksum INTEGER NOT NULL           -- XXH3 (64 bit) of the bytes of faces, seeded with that of
                                      -- areas, seeded with that of stage
);
)sql";

// The table of offsets is made when the tool space of a rigid tool is stored that has one.
inline constexpr char kContactOffsetSchema[] = R"sql(
CREATE TABLE contact_offset (
  scene_id      INTEGER NOT NULL REFERENCES scene,
  tool_space_id INTEGER NOT NULL,
  distance      NOT NULL,             -- by which the layer of contact is drawn back into the tool,
                                      -- m; the checksum of the tool space takes it in
  PRIMARY KEY (scene_id, tool_space_id)
);
)sql";

// The table of motions is made when the tool space of a rigid tool is stored that is not
// translated.
inline constexpr char kToolMotionSchema[] = R"sql(
CREATE TABLE tool_motion (
  scene_id      INTEGER NOT NULL REFERENCES scene,
  tool_space_id INTEGER NOT NULL,
  motion        INTEGER NOT NULL,     -- 1: through a trocar, 2: turned
  numbers       BLOB NOT NULL,        -- float64 [14] of a trocar: its place, m; the tool's axis
                                      -- towards the handle, in its own axes; the tip from the
                                      -- tool's centre, m; the direction about which it is moved;
                                      -- the largest angle to that, rad; the largest distance of
                                      -- the tip from the trocar, m, 0: any. [15] of a tool that
                                      -- is turned: the axis about which it is round, in its own
                                      -- axes, 0: it is not; its reference point from its centre,
                                      -- m; a quaternion w x y z of its middle orientation; the
                                      -- lever that makes angles lengths, m; the largest angle,
                                      -- rad; the angles of this tool space, rad. The checksum of
                                      -- the tool space takes all of this in
  PRIMARY KEY (scene_id, tool_space_id)
);
)sql";

// The table of regions is made when the tool space of a region is stored.
inline constexpr char kMeshRegionSchema[] = R"sql(
CREATE TABLE mesh_region (            -- of an organ that is divided: where a tool space serves
  scene_id      INTEGER NOT NULL REFERENCES scene,
  tool_space_id INTEGER NOT NULL,
  centre        BLOB NOT NULL,        -- float64 [3], m: the tool is in the region whose centre is
                                      -- nearest to it
  band          NOT NULL,             -- width of the layer in which a region passes into the next
                                      -- one, m; 0: it is that of an active node
  size          NOT NULL,             -- largest distance of a place of the surface from the
                                      -- centre of its region, as it was asked for, m
  tolerance     NOT NULL,             -- error of the force by the mesh that was asked for, a share;
                                      -- the checksum of the tool space takes all of this in
  PRIMARY KEY (scene_id, tool_space_id)
);
)sql";

// The table of the errors of the mesh is made when the first configuration is stored that has one.
inline constexpr char kMeshErrorSchema[] = R"sql(
CREATE TABLE mesh_error (             -- of a configuration, where it was estimated
  scene_id    INTEGER NOT NULL REFERENCES scene,
  tool_space_id INTEGER NOT NULL,
  i INTEGER NOT NULL, j INTEGER NOT NULL, k INTEGER NOT NULL,  -- check-point of the configuration
  level       INTEGER NOT NULL,       -- its level
  energy      NOT NULL,               -- that a finer mesh would still release, J
  force_x NOT NULL, force_y NOT NULL, force_z NOT NULL,  -- by which that of the configuration is
                                      -- too large, N
  is_reliable INTEGER NOT NULL,       -- 1: the estimate may be trusted
  checksum    INTEGER NOT NULL,       -- XXH3 (64 bit) of tool_space_id and of the columns from i to
                                      -- is_reliable, 8 bytes each
  PRIMARY KEY (scene_id, tool_space_id, i, j, k, level)
);
)sql";

// The table of what belongs to turns is made when the first configuration of a tool is stored that
// is turned.
inline constexpr char kTurnDerivativeSchema[] = R"sql(
CREATE TABLE turn_derivative (        -- of a configuration of a tool that is turned
  scene_id    INTEGER NOT NULL REFERENCES scene,
  tool_space_id INTEGER NOT NULL,
  i INTEGER NOT NULL, j INTEGER NOT NULL, k INTEGER NOT NULL,  -- check-point of the configuration
  level       INTEGER NOT NULL,       -- its level
  derivatives BLOB NOT NULL,          -- float64 [55 or 83], the first, second and third derivatives
                                      -- of the energy by all 5 or 6 coordinates, J/m^n: each in
                                      -- ascending order of the coordinates, the last one fastest
  checksum    INTEGER NOT NULL,       -- XXH3 (64 bit) of tool_space_id and of the columns from i to
                                      -- derivatives, 8 bytes each; of these, their number and the
                                      -- XXH3 of their bytes
  PRIMARY KEY (scene_id, tool_space_id, i, j, k, level)
);
)sql";

// The table of reduced models is made when the first array is stored: most files have none.
inline constexpr char kReducedSchema[] = R"sql(
CREATE TABLE reduced_array (          -- of a reduced model, or of what was found in its training
  scene_id    INTEGER NOT NULL REFERENCES scene,
  model       TEXT NOT NULL,          -- its key: the checksum of all that it follows from
  name        TEXT NOT NULL,          -- of the array
  num_arrays  INTEGER NOT NULL,       -- of the model, which is complete when all are there; 0: the
                                      -- array is of a training that is under way
  num_rows    INTEGER NOT NULL,
  num_columns INTEGER NOT NULL,
  checksum    INTEGER NOT NULL,       -- XXH3 (64 bit) of the bytes of numbers, seeded with that of
                                      -- model, then name, then num_arrays, num_rows and num_columns
  numbers     BLOB NOT NULL,          -- float64 [num_rows x num_columns], column by column
  PRIMARY KEY (scene_id, model, name)
);
)sql";

/// A table that not every file has: it is made when its first row is stored.
struct OptionalTable {
  const char* name;
  const char* schema;
};
inline constexpr OptionalTable optional_tables[] = {
    {"reduced_array", kReducedSchema},   {"body_force", kBodyForceSchema},
    {"boundary_array", kBoundarySchema}, {"contact_offset", kContactOffsetSchema},
    {"tool_motion", kToolMotionSchema},  {"mesh_region", kMeshRegionSchema},
    {"mesh_error", kMeshErrorSchema},    {"body_contact", kBodyContactSchema},
    {"body_cut", kBodyCutSchema},        {"turn_derivative", kTurnDerivativeSchema}};

}  // namespace palpate::storage
