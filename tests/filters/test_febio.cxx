// SPDX-License-Identifier: BSD-3-Clause
// A body in FEBio's file and back.
#include <gtest/gtest.h>

#include <sys/resource.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <string>

#include "assembly/scene.h"
#include "base/error.h"
#include "solvers/materials/point.h"
#include "vtkCellData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPalpateFEBioLaw.h"
#include "vtkPalpateFEBioModel.h"
#include "vtkPalpateFEBioUnits.h"
#include "vtkPalpateFEBioWriter.h"
#include "vtkPalpateScene.h"
#include "vtkStringOutputWindow.h"
#include "vtkUnstructuredGrid.h"

namespace {
using palpate::ElementOrder;
using palpate::Formulation;
using palpate::Index;
using palpate::Law;
using palpate::Material;
using palpate::Scene;

constexpr int kNotSaid = vtkPalpateFEBioUnits::NotSaid;
constexpr int kMillimetreNewton = 1;

/// A row of tetrahedra, each on a face of the one before, of coordinates that no short decimal
/// fraction holds; held at one corner.
Scene Row(ElementOrder order, int num_cells) {
  Scene scene;
  scene.mesh.order = order;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> aside(-0.1, 0.1);
  auto& points = scene.mesh.points;
  for (int i = 0; i < num_cells + 3; ++i) {
    // A helix, on which four points after each other make a tetrahedron.
    points.emplace_back(std::cos(2.1 * i) + aside(random), std::sin(2.1 * i) + aside(random),
                        0.4 * i + aside(random));
  }
  constexpr int edges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  for (Index i = 0; i < num_cells; ++i) {
    std::array<Index, 4> corners = {i, i + 1, i + 2, i + 3};
    const auto edge = [&](int a) { return points[corners[a]] - points[corners[0]]; };
    if (edge(1).cross(edge(2)).dot(edge(3)) < 0) std::swap(corners[2], corners[3]);
    scene.mesh.cells.insert(scene.mesh.cells.end(), corners.begin(), corners.end());
    for (const auto& [a, b] : edges) {
      if (order == ElementOrder::linear) break;
      const palpate::Vec3 middle = (points[corners[a]] + points[corners[b]]) / 2;
      const auto known = std::find(points.begin(), points.end(), middle);
      scene.mesh.cells.push_back(static_cast<Index>(known - points.begin()));
      if (known == points.end()) points.push_back(middle);
    }
  }
  scene.materials = {palpate::make_isotropic(Law::neo_hookean, 10000.1, 0.3)};
  scene.material_of_cell.assign(num_cells, 0);
  scene.fixed.assign(points.size(), 0);
  scene.fixed[0] = 1;
  scene.touchable.assign(points.size(), 0);
  scene.touchable[num_cells + 2] = 1;
  palpate::check(scene);
  return scene;
}

/// Writes the body; the message is empty where there is none.
std::string Write(vtkUnstructuredGrid* body, const std::string& name) {
  vtkNew<vtkStringOutputWindow> window;
  vtkNew<vtkPalpateFEBioWriter> writer;
  const vtkSmartPointer<vtkOutputWindow> before = vtkOutputWindow::GetInstance();
  vtkOutputWindow::SetInstance(window);
  writer->SetInputData(body);
  writer->SetFileName(name.c_str());
  const bool written = writer->Write() != 0;
  vtkOutputWindow::SetInstance(before);
  const std::string text = window->GetOutput();
  EXPECT_EQ(written, text.find("ERROR") == std::string::npos) << text;
  return text;
}

class Febio : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("palpate_febio_" + std::to_string(std::random_device()()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string file(const std::string& name = "body.feb") const {
    return (folder_ / name).string();
  }

  /// The scene after it was written and read; no message may come.
  Scene round_trip(const Scene& scene) {
    EXPECT_EQ(Write(vtkPalpateGridFromScene(scene), file()), "");
    return vtkPalpateReadFEBio(file(), kNotSaid).Scene;
  }

  /// What reading a file of this text throws; empty where it throws nothing.
  std::string error_of(const std::string& text, int units = kNotSaid) {
    std::ofstream(file("bad.feb")) << text;
    return error_of_file(file("bad.feb"), units);
  }

  static std::string error_of_file(const std::string& name, int units = kNotSaid) {
    try {
      static_cast<void>(vtkPalpateReadFEBio(name, units));
    } catch (const palpate::InputError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder_;
};

std::string Data(const std::string& name) { return std::string(PALPATE_TEST_DATA "/") + name; }

std::string TextOf(const std::string& name) {
  std::ifstream stream(name);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// The text with something replaced, which must be there.
std::string Replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t place = text.find(what);
  EXPECT_NE(place, std::string::npos) << what;
  return place == std::string::npos ? text : text.replace(place, what.size(), by);
}

/// To the last bit.
void ExpectSame(const Scene& a, const Scene& b) {
  EXPECT_EQ(palpate::hash(a), palpate::hash(b));
  EXPECT_EQ(a.mesh.points, b.mesh.points);
  EXPECT_EQ(a.mesh.cells, b.mesh.cells);
  EXPECT_EQ(a.fixed, b.fixed);
  EXPECT_EQ(a.touchable, b.touchable);
  for (Index cell = 0; cell < a.mesh.num_cells(); ++cell) {
    EXPECT_EQ(a.materials[a.material_of_cell[cell]], b.materials[b.material_of_cell[cell]]);
  }
}

/// One of each that FEBio has, with values that no short fraction holds.
std::vector<Material> WrittenMaterials() {
  using palpate::make_material;
  std::vector<Material> all = {
      make_material(Law::st_venant_kirchhoff, {1000.0 / 3, 0.1 + 0.2}),
      make_material(Law::neo_hookean, {1e5 / 7, 1.0 / 3}),
      make_material(Law::mooney_rivlin, {100.1, 10.3, 500.7}),
      make_material(Law::mooney_rivlin, {100.1, 0, 5e4 / 3}),
      make_material(Law::mooney_rivlin_polynomial,
                    {1000.7, 100.1, -10.3, 1.1, 2.2, 3.3, 0, 5.5, 6.6, 0}),
      make_material(Law::mooney_rivlin_polynomial, {3000.7, 100.1, 0, 1.1, 0, 0, 4.4, 0, 0, 0}),
      make_material(Law::ogden, {5e4 / 3, 631.1, -24.3, 0, 0, 7.7, 3.3})};
  all.push_back(palpate::with_formulation(all[2], Formulation::mixed));
  all.push_back(palpate::with_formulation(all[3], Formulation::displacement));
  return all;
}

TEST_F(Febio, ABodyComesBackTheSame) {
  for (const ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic}) {
    const std::vector<Material> materials = WrittenMaterials();
    Scene scene = Row(order, static_cast<int>(materials.size()) + 2);
    scene.materials = materials;
    for (std::size_t cell = 0; cell < scene.material_of_cell.size(); ++cell) {
      scene.material_of_cell[cell] = static_cast<Index>((cell + 1) % materials.size());
    }
    ExpectSame(round_trip(scene), scene);
  }
}

TEST_F(Febio, AFieldOfStiffnessComesBackTheSame) {
  constexpr int num_cells = 3 * vtkPalpateFEBioWriter::MostParts;
  Scene scene = Row(ElementOrder::linear, num_cells);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> modulus(1000, 9000);
  scene.materials.clear();
  for (int cell = 0; cell < num_cells; ++cell) {
    scene.material_of_cell[cell] = cell;
    scene.materials.push_back(
        cell % 3 == 0 ? palpate::make_isotropic(Law::neo_hookean, modulus(random), 0.3)
        : cell % 3 == 1
            ? palpate::make_mooney_rivlin(modulus(random), modulus(random), 20000.5)
            : palpate::make_material(Law::ogden, {1e5, modulus(random), cell % 2 ? 2.5 : -3.5}));
  }
  ExpectSame(round_trip(scene), scene);
  const std::string text = TextOf(file());
  EXPECT_NE(text.find("<E type=\"map\">Body_E</E>"), std::string::npos);
  EXPECT_NE(text.find("<v>0.3</v>"), std::string::npos);

  // One more map than FEBio has: its k is one number.
  for (int cell = 1; cell < num_cells; cell += 3) {
    scene.materials[cell] = palpate::make_mooney_rivlin(1000, 0, modulus(random) * 10);
  }
  const std::string message = Write(vtkPalpateGridFromScene(scene), file());
  EXPECT_NE(message.find("at most 100 are written"), std::string::npos) << message;
  EXPECT_NE(message.find("BulkModulus"), std::string::npos) << message;
}

TEST_F(Febio, APartIsForEachRegionAndMaterial) {
  Scene scene = Row(ElementOrder::linear, 4);
  scene.materials = {palpate::make_isotropic(Law::neo_hookean, 1000, 0.3),
                     palpate::make_isotropic(Law::neo_hookean, 2000, 0.3)};
  scene.material_of_cell = {0, 0, 1, 1};
  const auto grid = vtkPalpateGridFromScene(scene);
  vtkNew<vtkIntArray> regions;
  regions->SetName("RegionId");
  for (const int region : {7, 3, 3, 7}) regions->InsertNextValue(region);
  grid->GetCellData()->AddArray(regions);
  EXPECT_EQ(Write(grid, file()), "");
  const vtkPalpateFEBioModel model = vtkPalpateReadFEBio(file(), kNotSaid);
  EXPECT_EQ(model.Regions,
            (std::vector<std::string>{"Region7", "Region3", "Region3_2", "Region7_2"}));
  EXPECT_EQ(model.RegionOfCell, (std::vector<int>{0, 1, 2, 3}));
  ExpectSame(model.Scene, scene);
}

TEST_F(Febio, ALawThatFebioDefinesOtherwiseIsRefused) {
  using palpate::make_material;
  const std::vector<std::pair<Material, std::string>> refused = {
      {make_material(Law::linear, {1000, 0.3}), "'isotropic elastic' is St. Venant-Kirchhoff"},
      {make_material(Law::fung, {1000, 0.3, 2}), "'Veronda-Westmann'"},
      {make_material(Law::neo_hookean_incompressible, {1000}), "Assign Mooney-Rivlin"},
      {make_material(Law::mooney_rivlin_incompressible, {100, 10}), "Assign Mooney-Rivlin"},
      {make_material(Law::mooney_rivlin_polynomial, {3000, 100, 0, 0, 0, 0, 0, 0, 0, 1}),
       "Set C03 to 0"},
      {make_material(Law::mooney_rivlin_polynomial, {3000, 100, 1, 0, 0, 0, 1, 0, 0, 0}),
       "Set C03 to 0"}};
  for (const auto& [material, words] : refused) {
    Scene scene = Row(ElementOrder::linear, 2);
    scene.materials[0] = material;
    const std::string message = Write(vtkPalpateGridFromScene(scene), file());
    EXPECT_NE(message.find("The law " + palpate::to_string(material.law) + " cannot be written"),
              std::string::npos)
        << message;
    EXPECT_NE(message.find(words), std::string::npos) << message;
    EXPECT_FALSE(std::filesystem::exists(file()));
  }
}

/// The energy of FEBio 4 as its source has it (StrainEnergyDensity of the classes that
/// vtkPalpateFEBioLaw.h names), of its own parameters by their names.
double EnergyOfFebio(const std::string& type, std::map<std::string, double> p,
                     const palpate::Mat3& h) {
  const palpate::Mat3 f = palpate::Mat3::Identity() + h;
  const palpate::Mat3 c = f.transpose() * f;
  const double j = f.determinant();
  const palpate::Mat3 c_bar = c * std::pow(j, -2.0 / 3);
  const double i1 = c_bar.trace() - 3;
  const double i2 = (c_bar.trace() * c_bar.trace() - (c_bar * c_bar).trace()) / 2 - 3;
  const double u_of_j = 0.5 * p["k"] * (j - 1) * (j - 1);
  const double lam = p["v"] * p["E"] / ((1 + p["v"]) * (1 - 2 * p["v"]));
  const double mu = 0.5 * p["E"] / (1 + p["v"]);
  if (type == "isotropic elastic") {
    const palpate::Mat3 e = (c - palpate::Mat3::Identity()) / 2;
    return lam * e.trace() * e.trace() / 2 + mu * e.squaredNorm();
  }
  if (type == "neo-Hookean") {
    const double ln_j = std::log(j);
    return mu * ((c.trace() - 3) / 2 - ln_j) + lam * ln_j * ln_j / 2;
  }
  if (type == "Mooney-Rivlin") return p["c1"] * i1 + p["c2"] * i2 + u_of_j;
  if (type == "Yeoh") {
    return p["c1"] * i1 + p["c2"] * i1 * i1 + p["c3"] * i1 * i1 * i1 + u_of_j;
  }
  if (type == "polynomial") {
    double w = p["D1"] * (j - 1) * (j - 1);
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        w += p['c' + std::to_string(a) + std::to_string(b)] * std::pow(i1, a) * std::pow(i2, b);
      }
    }
    return w;
  }
  EXPECT_EQ(type, "Ogden");
  const Eigen::Vector3d squares = Eigen::SelfAdjointEigenSolver<palpate::Mat3>(c_bar).eigenvalues();
  double w = u_of_j;
  for (const char* term : {"1", "2", "3"}) {
    const double m = p[std::string("m") + term];
    if (m == 0) continue;
    w += p[std::string("c") + term] / (m * m) * (squares.array().pow(m / 2).sum() - 3);
  }
  return w;
}

TEST_F(Febio, TheEnergiesAreTheSame) {
  // Of the moduli, for the invariants less 3, whose digits cancel in FEBio's form.
  constexpr double rounding = 1e-13;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> entry(-0.2, 0.2);
  std::set<std::string> types;
  for (Material material : WrittenMaterials()) {
    material = palpate::with_formulation(material, Formulation::displacement);
    const vtkPalpateFEBioLaw& law = vtkPalpateFEBioLawOf(material);
    types.insert(law.Type);
    std::map<std::string, double> parameters;
    double largest = 0;
    for (const vtkPalpateFEBioLaw::Parameter& parameter : law.Parameters) {
      const double value = material.parameters[parameter.Index] * parameter.Factor;
      parameters[parameter.Name] = value;
      if (parameter.IsPressure) largest = std::max(largest, std::abs(value));
    }
    for (int trial = 0; trial < 20; ++trial) {
      const palpate::Mat3 h = palpate::Mat3::NullaryExpr([&] { return entry(random); });
      const double ours =
          palpate::test::respond<false>(material.law, law_constants(material), h).energy;
      EXPECT_NEAR(EnergyOfFebio(law.Type, parameters, h), ours, rounding * largest) << law.Type;
    }
  }
  EXPECT_EQ(types.size(), vtkPalpateFEBioLaws().size());
}

TEST_F(Febio, OfSpecification40WithUnitsOfItsOwn) {
  const vtkPalpateFEBioModel model = vtkPalpateReadFEBio(Data("febio_40.feb"), kNotSaid);
  const Scene& scene = model.Scene;
  ASSERT_EQ(scene.mesh.num_cells(), 2);
  // In the order of the ids, which are not the places.
  EXPECT_EQ(scene.mesh.cells, (std::vector<Index>{0, 1, 2, 3, 1, 2, 3, 4}));
  EXPECT_EQ(scene.mesh.points[4], palpate::Vec3(0.01, 0.01, 0.01));
  EXPECT_EQ(scene.materials[scene.material_of_cell[0]],
            palpate::make_isotropic(Law::neo_hookean, 6000, 0.4));
  EXPECT_EQ(scene.materials[scene.material_of_cell[1]],
            palpate::with_formulation(palpate::make_mooney_rivlin(2000, 1000, 500000),
                                      Formulation::mixed));
  EXPECT_EQ(scene.fixed, (std::vector<char>{1, 1, 1, 0, 0}));
  EXPECT_EQ(scene.touchable, (std::vector<char>{0, 0, 0, 0, 1}));
  EXPECT_EQ(model.Regions, (std::vector<std::string>{"Part2", "Part1"}));
  EXPECT_EQ(model.RegionOfCell, (std::vector<int>{1, 0}));
  EXPECT_TRUE(model.Warnings.empty());
}

TEST_F(Febio, OfSpecification30) {
  const vtkPalpateFEBioModel model = vtkPalpateReadFEBio(Data("febio_30.feb"), kNotSaid);
  EXPECT_EQ(
      model.Scene.materials[0],
      palpate::with_formulation(palpate::make_material(Law::ogden, {50000, 631, -24, 0, 0, 50, 3}),
                                Formulation::displacement));
  EXPECT_EQ(model.Scene.fixed, (std::vector<char>{1, 1, 1, 0}));
  // Where there is no set of that name, the corners of the surface that are free.
  EXPECT_EQ(model.Scene.touchable, (std::vector<char>{0, 0, 0, 1}));
  ASSERT_EQ(model.Warnings.size(), 2U);
  EXPECT_EQ(model.Warnings[0].rfind("<surface_load name=\"Pressure1\">", 0), 0U);
  EXPECT_EQ(model.Warnings[1].rfind("<bc name=\"Pull\">", 0), 0U);
}

TEST_F(Febio, OfSpecification25WithUnitsThatAreSaid) {
  const vtkPalpateFEBioModel model = vtkPalpateReadFEBio(Data("febio_25.feb"), kMillimetreNewton);
  const Scene& scene = model.Scene;
  EXPECT_EQ(scene.mesh.order, ElementOrder::quadratic);
  EXPECT_EQ(scene.materials[0], palpate::make_isotropic(Law::st_venant_kirchhoff, 5e6, 0.3));
  EXPECT_EQ(scene.fixed, (std::vector<char>{1, 1, 1, 0, 1, 1, 1, 0, 0, 0}));
  // Each midside node is in the middle of the edge that VTK means by its place.
  constexpr int edges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  const Index* nodes = scene.mesh.cell(0);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(scene.mesh.points[nodes[4 + i]],
              (scene.mesh.points[nodes[edges[i][0]]] + scene.mesh.points[nodes[edges[i][1]]]) / 2);
  }
}

TEST_F(Febio, SaysWhatIsWrong) {
  const std::string good = TextOf(Data("febio_40.feb"));
  EXPECT_EQ(error_of(good), "");
  const auto expect = [&](const std::string& what, const std::string& by,
                          const std::string& words) {
    const std::string message = error_of(Replaced(good, what, by));
    EXPECT_NE(message.find(words), std::string::npos) << words << "\n" << message;
    EXPECT_NE(message.find("bad.feb"), std::string::npos) << message;
  };
  expect("<?xml", "solid", "is no XML");
  expect("</febio_spec>", "", "no element found");
  expect("<Material>", "<Material><a>", "mismatched tag");
  expect("version=\"4.0\"", "version=\"1.2\"", "specification 1.2; 2.5, 3.0 and 4.0 are read");
  expect("type=\"solid\"", "type=\"biphasic\"", "module 'biphasic'");
  expect("<units>mm-N-s</units>", "", "Set Units to those in which the model was made");
  expect("mm-N-s", "inch", "its units are 'inch'");
  expect("type=\"tet4\"", "type=\"hex8\"", "elements of the type 'hex8'");
  expect("type=\"tet4\"", "type=\"tet10\"", "has not the 10 nodes of a tet10");
  expect("type=\"neo-Hookean\"", "type=\"Holmes-Mow\"", "type 'Holmes-Mow', which is not read");
  expect("<pressure_model>Abaqus</pressure_model>", "", "Set its pressure_model to 2");
  expect("<pressure_model>Abaqus", "<pressure_model>default", "Set its pressure_model to 2");
  expect("<E>0.006</E>", "<E lc=\"1\">0.006</E>", "follows a load curve");
  expect("<E>0.006</E>", "<E>a+b</E>", "'a+b' where numbers");
  expect("<E>0.006</E>", "<E>-1</E>", "Young's modulus is -1e+06");
  expect("<E>0.006</E>", "<E type=\"map\">m</E>", "no map 'm'");
  expect("<E>0.006</E>", "<E>0.006</E><w>3</w>", "has w = 3");
  expect("2,3,5,6", "2,3,5,4", "<elem id=\"7\"> has the node 4, which is not among the nodes");
  expect("2,3,5,6", "2,3,5", "has not the 4 nodes of a tet4");
  expect("2,3,5,6", "2,3,5,x", "'2,3,5,x' where numbers");
  expect("10,10,10", "10,10", "where three coordinates are due");
  expect("10,10,10", "10,nan,10", "not finite");
  expect("10,10,10", "10,0,0", "no volume");
  expect("<node id=\"6\"", "<node id=\"5\"", "two nodes with the id 5");
  expect("<elem id=\"7\"", "<elem id=\"2\"", "two elements with the id 2");
  expect("<elem id=\"7\"", "<elem", "no attribute id");
  expect("<z_dof>1</z_dof>", "<z_dof>0</z_dof>", "node 1 is held along x and y alone");
  expect("@surface:Base\"", "Nowhere\"", "no set of that name");
  expect("mat=\"Nodule\"", "mat=\"None\"", "no material 'None'");
  expect("<SolidDomain name=\"Part2\"", "<SolidDomain name=\"Part3\"",
         "no <SolidDomain name=\"Part2\">");
  expect(">6</NodeSet>", ">1:1000000000000</NodeSet>", "longer than any mesh");
  expect("<Output>", "<Contact><contact type=\"sliding\"/></Contact><Output>", "<Contact>");
  expect("<Output>", "<Include>mesh.feb</Include><Output>", "another file");
  expect("<Output>",
         "<Step><step id=\"1\"><Boundary><bc name=\"In\" type=\"zero displacement\"/></Boundary>"
         "</step></Step><Output>",
         "holds during a step alone");
  expect("type=\"zero displacement\"", "type=\"rigid\"", "is not read");

  const auto of = [&](const std::string& text) { return error_of(text); };
  EXPECT_NE(of("").find("no element found"), std::string::npos) << of("");
  EXPECT_NE(of("<VTKFile/>").find("its root is <VTKFile>"), std::string::npos);
  EXPECT_NE(of("<febio_spec version=\"4.0\"><Module><units>SI</units></Module></febio_spec>")
                .find("no mesh"),
            std::string::npos);
  EXPECT_NE(of("<febio_spec version=\"4.0\"><Module><units>SI</units></Module><Mesh/></febio_spec>")
                .find("no elements"),
            std::string::npos);
  std::string deep;
  for (int level = 0; level < 100000; ++level) deep += "<a>";
  EXPECT_NE(of(deep).find("levels of elements"), std::string::npos);
  EXPECT_NE(error_of_file(file("nowhere.feb")).find("cannot be opened"), std::string::npos);
  EXPECT_NE(error_of_file(folder_.string()).find("is a folder"), std::string::npos);
  EXPECT_NE(error_of(good, kMillimetreNewton + 1).find("Units is mm-kg-s, but"), std::string::npos);
  EXPECT_NE(error_of(good, 7).find("Units is 7; there are"), std::string::npos);
}

TEST_F(Febio, AFileThatCannotBeWrittenIsSaid) {
  const auto grid = vtkPalpateGridFromScene(Row(ElementOrder::linear, 2));
  EXPECT_NE(Write(grid, file("none/body.feb")).find("No such file"), std::string::npos);
  EXPECT_NE(Write(grid, folder_.string()).find("Is a directory"), std::string::npos);
  EXPECT_NE(Write(grid, "/dev/full").find("No space left"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists("/dev/full"));
  EXPECT_NE(Write(grid, "").find("No file is named"), std::string::npos);
}

TEST_F(Febio, AFileThatWasThereStaysWhereWritingFails) {
  const Scene scene = Row(ElementOrder::linear, 2);
  const auto grid = vtkPalpateGridFromScene(scene);
  ASSERT_EQ(Write(grid, file()), "");
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit full = before;
  full.rlim_cur = 1000;  // bytes, as of a disk that is full
  std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &full), 0);
  const std::string message = Write(vtkPalpateGridFromScene(Row(ElementOrder::linear, 20)), file());
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_NE(message.find("cannot be written"), std::string::npos) << message;
  ExpectSame(vtkPalpateReadFEBio(file(), kNotSaid).Scene, scene);
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(file()).parent_path())) {
    EXPECT_NE(entry.path().extension(), ".part") << "a half file stays";
  }
}

TEST_F(Febio, SaysWhatTheFileDoesNot) {
  Scene scene = Row(ElementOrder::quadratic, 2);
  scene.materials[0] = palpate::make_isotropic(Law::neo_hookean, 1000, 0.49);
  std::string message = Write(vtkPalpateGridFromScene(scene), file());
  EXPECT_NE(message.find("too stiff"), std::string::npos) << message;
  ExpectSame(vtkPalpateReadFEBio(file(), kNotSaid).Scene, scene);
  scene = Row(ElementOrder::quadratic, 2);
  scene.touchable.assign(scene.touchable.size(), 0);
  message = Write(vtkPalpateGridFromScene(scene), file());
  EXPECT_NE(message.find("No point may be touched"), std::string::npos) << message;
}
}  // namespace
