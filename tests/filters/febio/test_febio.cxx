// SPDX-License-Identifier: BSD-3-Clause
// A body in FEBio's file and back.
#include <gtest/gtest.h>

#include <sys/resource.h>
#include <sys/stat.h>

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

#include "assembly/loaded_faces.h"
#include "assembly/scene.h"
#include "base/error.h"
#include "base/own_seconds.h"
#include "solvers/materials/point.h"
#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPalpateFEBioLaw.h"
#include "vtkPalpateFEBioModel.h"
#include "vtkPalpateFEBioReader.h"
#include "vtkPalpateFEBioUnits.h"
#include "vtkPalpateFEBioWriter.h"
#include "vtkPalpateMaterials.h"
#include "vtkPalpateScene.h"
#include "vtkPointData.h"
#include "vtkStringArray.h"
#include "vtkStringOutputWindow.h"
#include "vtkUnstructuredGrid.h"
#include "vtkVariant.h"

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
  scene.body.mesh.order = order;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> aside(-0.1, 0.1);
  auto& points = scene.body.mesh.points;
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
    scene.body.mesh.cells.insert(scene.body.mesh.cells.end(), corners.begin(), corners.end());
    for (const auto& [a, b] : edges) {
      if (order == ElementOrder::linear) break;
      const palpate::Vec3 middle = (points[corners[a]] + points[corners[b]]) / 2;
      const auto known = std::find(points.begin(), points.end(), middle);
      scene.body.mesh.cells.push_back(static_cast<Index>(known - points.begin()));
      if (known == points.end()) points.push_back(middle);
    }
  }
  scene.organ.materials = {palpate::make_isotropic(Law::neo_hookean, 10000.1, 0.3)};
  scene.body.material_of_cell.assign(num_cells, 0);
  scene.body.fixed.assign(points.size(), 0);
  scene.body.fixed[0] = 1;
  scene.body.touchable.assign(points.size(), 0);
  scene.body.touchable[num_cells + 2] = 1;
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

/// What of its arrays, on points, cells and as a whole, another grid lacks or has otherwise.
std::set<std::string> ArraysThatDiffer(vtkUnstructuredGrid* one, vtkUnstructuredGrid* other) {
  std::set<std::string> names;
  const std::pair<vtkFieldData*, vtkFieldData*> all[] = {
      {one->GetPointData(), other->GetPointData()},
      {one->GetCellData(), other->GetCellData()},
      {one->GetFieldData(), other->GetFieldData()}};
  for (const auto& [data, others] : all) {
    for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
      vtkAbstractArray* array = data->GetAbstractArray(i);
      vtkAbstractArray* same = others->GetAbstractArray(array->GetName());
      bool differs = same == nullptr || same->GetNumberOfValues() != array->GetNumberOfValues();
      for (vtkIdType value = 0; !differs && value < array->GetNumberOfValues(); ++value) {
        differs =
            array->GetVariantValue(value).ToString() != same->GetVariantValue(value).ToString();
      }
      if (differs) names.insert(array->GetName());
    }
  }
  return names;
}

vtkSmartPointer<vtkUnstructuredGrid> Read(const std::string& name) {
  vtkNew<vtkPalpateFEBioReader> reader;
  reader->SetFileName(name.c_str());
  reader->Update();
  return reader->GetOutput();
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
  EXPECT_EQ(a.body.mesh.points, b.body.mesh.points);
  EXPECT_EQ(a.body.mesh.cells, b.body.mesh.cells);
  EXPECT_EQ(a.body.fixed, b.body.fixed);
  EXPECT_EQ(a.body.touchable, b.body.touchable);
  for (Index cell = 0; cell < a.body.mesh.num_cells(); ++cell) {
    EXPECT_EQ(a.organ.materials[a.body.material_of_cell[cell]],
              b.organ.materials[b.body.material_of_cell[cell]]);
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
    scene.organ.materials = materials;
    for (std::size_t cell = 0; cell < scene.body.material_of_cell.size(); ++cell) {
      scene.body.material_of_cell[cell] = static_cast<Index>((cell + 1) % materials.size());
    }
    ExpectSame(round_trip(scene), scene);
  }
}

TEST_F(Febio, AFieldOfStiffnessComesBackTheSame) {
  constexpr int num_cells = 3 * vtkPalpateFEBioWriter::MostParts;
  Scene scene = Row(ElementOrder::linear, num_cells);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> modulus(1000, 9000);
  scene.organ.materials.clear();
  for (int cell = 0; cell < num_cells; ++cell) {
    scene.body.material_of_cell[cell] = cell;
    scene.organ.materials.push_back(
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
    scene.organ.materials[cell] = palpate::make_mooney_rivlin(1000, 0, modulus(random) * 10);
  }
  const std::string message = Write(vtkPalpateGridFromScene(scene), file());
  EXPECT_NE(message.find("at most 100 are written"), std::string::npos) << message;
  EXPECT_NE(message.find("BulkModulus"), std::string::npos) << message;
}

TEST_F(Febio, APartIsForEachRegionAndMaterial) {
  Scene scene = Row(ElementOrder::linear, 4);
  scene.organ.materials = {palpate::make_isotropic(Law::neo_hookean, 1000, 0.3),
                           palpate::make_isotropic(Law::neo_hookean, 2000, 0.3)};
  scene.body.material_of_cell = {0, 0, 1, 1};
  const auto grid = vtkPalpateGridFromScene(scene);
  vtkNew<vtkIntArray> regions;
  regions->SetName("RegionId");
  for (const int region : {7, 3, 3, 7}) regions->InsertNextValue(region);
  grid->GetCellData()->AddArray(regions);
  const std::string message = Write(grid, file());
  EXPECT_NE(message.find("The numbers of RegionId are in the names of the parts alone"),
            std::string::npos)
      << message;
  const vtkPalpateFEBioModel model = vtkPalpateReadFEBio(file(), kNotSaid);
  EXPECT_EQ(model.Regions,
            (std::vector<std::string>{"Region7", "Region3", "Region3_2", "Region7_2"}));
  EXPECT_EQ(model.RegionOfCell, (std::vector<int>{0, 1, 2, 3}));
  ExpectSame(model.Scene, scene);
}

// Numbers and names of regions that are those of the parts come back.
TEST_F(Febio, TheRegionsOfAFileComeBack) {
  Scene scene = Row(ElementOrder::linear, 4);
  const auto grid = vtkPalpateGridFromScene(scene);
  vtkNew<vtkIntArray> regions;
  regions->SetName("RegionId");
  for (const int region : {0, 1, 1, 0}) regions->InsertNextValue(region);
  grid->GetCellData()->AddArray(regions);
  vtkNew<vtkStringArray> names;
  names->SetName("Regions");
  names->InsertNextValue("Liver & lobe");
  names->InsertNextValue("Nodule");
  grid->GetFieldData()->AddArray(names);
  EXPECT_EQ(Write(grid, file()), "");
  EXPECT_EQ(ArraysThatDiffer(grid, Read(file())), std::set<std::string>{});
  // Two of one name.
  names->SetValue(1, "Liver & lobe");
  EXPECT_EQ(Write(grid, file()), "");
  EXPECT_EQ(vtkPalpateReadFEBio(file(), kNotSaid).Regions,
            (std::vector<std::string>{"Liver & lobe", "Liver & lobe_2"}));
}

palpate::Rheology Viscous(double density, std::array<double, 4> moduli,
                          std::array<double, 4> times) {
  palpate::Rheology rheology;
  rheology.density = density;
  rheology.prony_moduli = moduli;
  rheology.prony_times = times;
  return rheology;
}

// Of each law and formulation: without and with viscosity, also with a term that is left free.
TEST_F(Febio, DensityAndViscosityComeBackTheSame) {
  const std::vector<palpate::Rheology> rheologies = {
      Viscous(0, {}, {}), Viscous(1060.1, {}, {}),
      Viscous(1000.0 / 3, {0.5, 1.0 / 3, 0.2, 0.1}, {0.01, 0.1 / 3, 1, 7}),
      Viscous(2, {0, 0.7}, {0, 0.3})};
  std::vector<Material> materials = WrittenMaterials();
  Scene scene =
      Row(ElementOrder::quadratic, static_cast<int>(materials.size() * rheologies.size()));
  scene.organ.materials.clear();
  std::vector<palpate::Rheology> of_cell;
  for (const Material& material : materials) {
    for (const palpate::Rheology& rheology : rheologies) {
      scene.body.material_of_cell[of_cell.size()] = static_cast<Index>(of_cell.size());
      scene.organ.materials.push_back(material);
      of_cell.push_back(rheology);
    }
  }
  const auto grid = vtkPalpateGridFromScene(scene);
  vtkPalpateWriteRheologies(of_cell, scene.body.material_of_cell, grid);
  ASSERT_TRUE(grid->GetCellData()->HasArray("PronyTime4"));
  EXPECT_EQ(Write(grid, file()), "");
  const auto back = Read(file());
  EXPECT_EQ(ArraysThatDiffer(grid, back), std::set<std::string>{});
  back->GetCellData()->RemoveArray("RegionId");
  back->GetPointData()->RemoveArray("BoundaryKind");
  back->GetFieldData()->RemoveArray("Regions");
  EXPECT_EQ(ArraysThatDiffer(back, grid), std::set<std::string>{});
  const std::string text = TextOf(file());
  EXPECT_NE(text.find("type=\"viscoelastic\""), std::string::npos);
  EXPECT_NE(text.find("type=\"uncoupled viscoelastic\""), std::string::npos);
}

TEST_F(Febio, AFieldOfDensityComesBackTheSame) {
  constexpr int num_cells = 2 * vtkPalpateFEBioWriter::MostParts;
  Scene scene = Row(ElementOrder::linear, num_cells);
  scene.organ.materials.assign(num_cells, scene.organ.materials[0]);
  std::vector<palpate::Rheology> rheologies;
  for (int cell = 0; cell < num_cells; ++cell) {
    scene.body.material_of_cell[cell] = cell;
    rheologies.push_back(Viscous(1000 + cell / 7.0, {0.5}, {0.1}));
  }
  const auto grid = vtkPalpateGridFromScene(scene);
  vtkPalpateWriteRheologies(rheologies, scene.body.material_of_cell, grid);
  EXPECT_EQ(Write(grid, file()), "");
  EXPECT_NE(TextOf(file()).find("<density type=\"map\">Body_density</density>"), std::string::npos);
  EXPECT_EQ(ArraysThatDiffer(grid, Read(file())), std::set<std::string>{});

  // One number for a material there.
  for (int cell = 0; cell < num_cells; ++cell) rheologies[cell].prony_times[0] += cell;
  vtkPalpateWriteRheologies(rheologies, scene.body.material_of_cell, grid);
  const std::string message = Write(grid, file());
  EXPECT_NE(message.find("PronyTime"), std::string::npos) << message;
  EXPECT_NE(message.find("at most 100 are written"), std::string::npos) << message;
}

// What is neither in the file nor computed the same by FEBio is named.
TEST_F(Febio, WhatIsLeftOutIsNamed) {
  Scene scene = Row(ElementOrder::linear, 3);
  scene.organ.materials = {
      palpate::make_isotropic(Law::neo_hookean, 1000, 0.49),
      palpate::with_formulation(palpate::make_isotropic(Law::neo_hookean, 9, 0.3),
                                Formulation::mixed)};
  scene.body.material_of_cell = {0, 1, 1};
  const auto grid = vtkPalpateGridFromScene(scene);
  std::vector<palpate::Rheology> rheologies(2, Viscous(1, {0.5}, {0.1}));
  rheologies[1].viscous_time = 0.02;
  vtkPalpateWriteRheologies(rheologies, scene.body.material_of_cell, grid);
  const auto add = [](vtkFieldData* data, const char* name, vtkIdType size) {
    vtkNew<vtkIntArray> array;
    array->SetName(name);
    for (vtkIdType i = 0; i < size; ++i) array->InsertNextValue(3);
    data->AddArray(array);
  };
  add(grid->GetPointData(), "Grey", grid->GetNumberOfPoints());
  add(grid->GetCellData(), "Part", 3);
  add(grid->GetFieldData(), "Vol\nume", 1);
  const std::string message = Write(grid, file());
  for (const std::string& name : ArraysThatDiffer(grid, Read(file()))) {
    EXPECT_NE(message.find(name == "Vol\nume" ? "Vol\\x0aume" : name), std::string::npos)
        << name << "\n"
        << message;
  }
  for (const char* words : {"Formulation is left out", "ViscousTime, is left out",
                            "relaxes in shape alone here", "'Part' (cells)", "'Grey' (points)"}) {
    EXPECT_NE(message.find(words), std::string::npos) << words << "\n" << message;
  }
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
    scene.organ.materials[0] = material;
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
  ASSERT_EQ(scene.body.mesh.num_cells(), 2);
  // In the order of the ids, which are not the places.
  EXPECT_EQ(scene.body.mesh.cells, (std::vector<Index>{0, 1, 2, 3, 1, 2, 3, 4}));
  EXPECT_EQ(scene.body.mesh.points[4], palpate::Vec3(0.01, 0.01, 0.01));
  EXPECT_EQ(scene.organ.materials[scene.body.material_of_cell[0]],
            palpate::make_isotropic(Law::neo_hookean, 6000, 0.4));
  EXPECT_EQ(scene.organ.materials[scene.body.material_of_cell[1]],
            palpate::with_formulation(palpate::make_mooney_rivlin(2000, 1000, 500000),
                                      Formulation::mixed));
  EXPECT_EQ(scene.body.fixed, (std::vector<char>{1, 1, 1, 0, 0}));
  EXPECT_EQ(scene.body.touchable, (std::vector<char>{0, 0, 0, 0, 1}));
  EXPECT_EQ(model.Regions, (std::vector<std::string>{"Part2", "Part1"}));
  EXPECT_EQ(model.RegionOfCell, (std::vector<int>{1, 0}));
  EXPECT_TRUE(model.Warnings.empty());
}

// A series of another hand: in any order, with a time twice, and with the stress of the beginning.
TEST_F(Febio, AViscousMaterialOfAnotherHand) {
  const std::string good = TextOf(Data("febio_40.feb"));
  const std::string soft = "type=\"neo-Hookean\">";
  const auto viscous = [&](const std::string& series, const std::string& type) {
    std::string text = Replaced(good, soft, "type=\"" + type + "\">" + series + "<elastic " + soft);
    return Replaced(text, "<v>0.4</v>", "<v>0.4</v></elastic>");
  };
  const auto read = [&](const std::string& text) {
    std::ofstream(file()) << text;
    return vtkPalpateReadFEBio(file(), kNotSaid);
  };
  const std::string series =
      "<g0>0.5</g0><g1>0.25</g1><t1>2</t1><g3>0.5</g3><t3>0.1</t3><g6>0.125</g6><t6>2</t6>";
  const std::string density = "<density>0.5</density>";
  const vtkPalpateFEBioModel model = read(viscous(density + series, "viscoelastic"));
  const Index material = model.Scene.body.material_of_cell[0];
  EXPECT_EQ(model.Scene.organ.materials[material],
            palpate::make_isotropic(Law::neo_hookean, 3000, 0.4));
  EXPECT_EQ(model.Rheologies[material], Viscous(5e11, {1, 0.75}, {0.1, 2}));
  EXPECT_TRUE(model.Warnings.empty());
  // FEBio takes the density of the outer material.
  const vtkPalpateFEBioModel light = read(viscous(series, "viscoelastic"));
  EXPECT_EQ(light.Rheologies[light.Scene.body.material_of_cell[0]],
            Viscous(0, {1, 0.75}, {0.1, 2}));
  ASSERT_EQ(light.Warnings.size(), 1U);
  EXPECT_NE(light.Warnings[0].find("Liver has no density"), std::string::npos) << light.Warnings[0];

  const auto expect = [&](const std::string& text, const std::string& words) {
    const std::string message = error_of(text);
    EXPECT_NE(message.find(words), std::string::npos) << words << "\n" << message;
  };
  expect(viscous("", "uncoupled viscoelastic"), "is not uncoupled. Use 'viscoelastic'");
  expect(Replaced(good, soft, "type=\"viscoelastic\">"), "has no <elastic>");
  expect(viscous("<g1>-1</g1>", "viscoelastic"), "ratio 1 (PronyModuli) is -1");
  expect(viscous("<g1>1</g1><t1>0</t1>", "viscoelastic"), "Give both above 0");
  expect(viscous("<g1>nan</g1>", "viscoelastic"), "ratio 1 (PronyModuli)");
  expect(viscous("<g0>0</g0><g1>1</g1>", "viscoelastic"), "has g0 = 0");
  expect(viscous("<g1 lc=\"1\">1</g1>", "viscoelastic"), "follows a load curve");
  expect(viscous("<g1 type=\"map\">m</g1>", "viscoelastic"), "of the type 'map'");
  expect(viscous("<g1>1</g1><t1>1</t1><g2>1</g2><t2>2</t2><g3>1</g3><t3>3</t3><g4>1</g4><t4>4</t4>"
                 "<g5>1</g5><t5>5</t5>",
                 "viscoelastic"),
         "Prony series of 5 terms");
}

// FEBio takes k and the pressure_model of the outer one, and before version 4 k of the inner one
// too.
TEST_F(Febio, AnUncoupledViscousMaterialOfAnotherHand) {
  const std::string good = TextOf(Data("febio_40.feb"));
  const std::size_t begin = good.find("<material id=\"2\"");
  const std::size_t end = good.find("</material>", begin);
  ASSERT_NE(begin, std::string::npos);
  const auto text_with = [&](const std::string& material) {
    return std::string(good).replace(begin, end - begin, material);
  };
  const std::string head = "<material id=\"2\" name=\"Nodule\" type=\"";
  const std::string law = "<elastic type=\"Mooney-Rivlin\"><c1>0.002</c1><c2>0.001</c2>";
  const std::string series = "<density>0.5</density><g1>0.5</g1><t1>0.1</t1>";
  const auto read = [&](const std::string& material) {
    std::ofstream(file()) << text_with(material);
    const vtkPalpateFEBioModel model = vtkPalpateReadFEBio(file(), kNotSaid);
    EXPECT_EQ(model.Scene.organ.materials[model.Scene.body.material_of_cell[1]],
              palpate::with_formulation(palpate::make_mooney_rivlin(2000, 1000, 500000),
                                        Formulation::mixed));
    EXPECT_EQ(model.Rheologies[model.Scene.body.material_of_cell[1]], Viscous(5e11, {0.5}, {0.1}));
    return model.Warnings;
  };
  const std::string outer =
      head + "uncoupled viscoelastic\">" + series + "<k>0.5</k><pressure_model>2</pressure_model>";
  EXPECT_TRUE(read(outer + law + "</elastic>").empty());
  const std::vector<std::string> warnings =
      read(head + "uncoupled viscoelastic\">" + series + law + "<k>0.5</k></elastic>");
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("Nodule resists a change of volume by k/2 (ln J)^2"),
            std::string::npos)
      << warnings[0];
  const auto expect = [&](const std::string& material, const std::string& words) {
    const std::string message = error_of(text_with(material));
    EXPECT_NE(message.find(words), std::string::npos) << words << "\n" << message;
  };
  expect(outer + law + "<k>0.5</k></elastic>", "has k twice");
  expect(head + "viscoelastic\">" + series + law + "<k>0.5</k></elastic>",
         "Use 'uncoupled viscoelastic' for its material");
}

// Each pressure_model of FEBio has the modulus of ours at rest, and another pressure beyond.
TEST_F(Febio, AnotherPressureModelIsReadAndTold) {
  const std::string good = TextOf(Data("febio_40.feb"));
  const std::string ours = "<pressure_model>Abaqus</pressure_model>";
  const Scene scene = vtkPalpateReadFEBio(Data("febio_40.feb"), kNotSaid).Scene;
  const std::map<std::string, std::string> told = {
      {"", "1.5 %"},       {"0", "1.5 %"}, {"default", "1.5 %"},
      {"NIKE3D", "0.5 %"}, {"1", "0.5 %"}, {"Abaqus (GOH)", "0.5 %"},
      {"2", ""},           {"Abaqus", ""}};
  for (const auto& [model, words] : told) {
    std::ofstream(file()) << Replaced(
        good, ours, model.empty() ? "" : "<pressure_model>" + model + "</pressure_model>");
    const vtkPalpateFEBioModel read = vtkPalpateReadFEBio(file(), kNotSaid);
    ExpectSame(read.Scene, scene);
    ASSERT_EQ(read.Warnings.size(), words.empty() ? 0U : 1U) << model;
    if (!words.empty()) {
      EXPECT_NE(read.Warnings[0].find(words), std::string::npos) << read.Warnings[0];
    }
  }
  // The figures that are told, of the pressure that FEBio's source has.
  constexpr double j = 1.01;
  constexpr double tenth = 0.1;  // %, as they are told with two digits
  const double pressures[] = {std::log(j) / j, (j - 1 / j) / 2, j - 1, (j - 1 / j) / 2};
  for (int model = 0; model < 4; ++model) {
    EXPECT_NEAR(100 * std::abs(pressures[model] / (j - 1) - 1),
                vtkPalpateFEBioPressureModel::All()[model].Difference, tenth);
  }
}

// A plane of symmetry is points that are held along one axis, or FEBio's constraint.
TEST_F(Febio, PointsHeldAlongSomeAxesAreRead) {
  const std::string good = TextOf(Data("febio_40.feb"));
  const auto read = [&](const std::string& text) {
    std::ofstream(file()) << text;
    const vtkPalpateFEBioModel model = vtkPalpateReadFEBio(file(), kNotSaid);
    EXPECT_TRUE(model.Warnings.empty());
    return model.Scene;
  };
  palpate::HeldDirections held = palpate::HeldDirections::Identity();
  const palpate::HeldDirections none = palpate::HeldDirections::Zero();
  Scene scene = read(Replaced(good, "<z_dof>1</z_dof>", "<z_dof>0</z_dof>"));
  EXPECT_EQ(scene.body.fixed, (std::vector<char>(5, 0)));
  EXPECT_EQ(scene.body.held_directions,
            (std::vector<palpate::HeldDirections>{held, held, held, none, none}));
  scene = read(Replaced(good, "<x_dof>1</x_dof>\n\t\t\t<y_dof>1</y_dof>",
                        "<x_dof>0</x_dof>\n\t\t\t<y_dof>0</y_dof>"));
  held << 0, 0, 0, 0, 1, 0;
  EXPECT_EQ(scene.body.held_directions,
            (std::vector<palpate::HeldDirections>{held, held, held, none, none}));

  const std::string slope =
      "<Surface name=\"Slope\"><tri3 id=\"1\">2,3,5</tri3></Surface><NodeSet name=\"Touchable\">";
  const std::string with_slope = Replaced(good, "<NodeSet name=\"Touchable\">", slope);
  const auto constrained = [&](const std::string& constraint) {
    return Replaced(with_slope, "<Output>",
                    "<Constraints>" + constraint + "</Constraints><Output>");
  };
  const std::string plane = "<constraint type=\"symmetry plane\" surface=\"";
  scene = read(constrained(plane + "Slope\"/>"));
  // The first three are fixed.
  EXPECT_EQ(scene.body.fixed, (std::vector<char>{1, 1, 1, 0, 0}));
  held << palpate::Vec3::Ones() / std::sqrt(3.0), palpate::Vec3::Zero();
  ASSERT_EQ(scene.body.held_directions.size(), 5U);
  EXPECT_TRUE(scene.body.held_directions[3].isApprox(held));
  EXPECT_EQ(scene.body.held_directions[2], none);
  // With a plane through all three axes' directions a point is fixed.
  scene = read(Replaced(constrained(plane + "Slope\"/>"), "<z_dof>1</z_dof>", "<z_dof>0</z_dof>"));
  EXPECT_EQ(scene.body.fixed, (std::vector<char>{0, 1, 1, 0, 0}));

  const auto expect = [&](const std::string& text, const std::string& words) {
    const std::string message = error_of(text);
    EXPECT_NE(message.find(words), std::string::npos) << words << "\n" << message;
  };
  expect(constrained("<constraint type=\"volume\" surface=\"Base\"/>"), "but for a symmetry plane");
  expect(constrained(plane + "None\"/>"), "surface 'None', which is not there");
  expect(Replaced(constrained(plane + "Slope\"/>"), "2,3,5</tri3>",
                  "2,3,5</tri3><tri3 id=\"2\">1,2,3</tri3>"),
         "is no plane");
  expect(Replaced(constrained(plane + "Slope\"/>"), "2,3,5</tri3>", "2,3</tri3>"),
         "has 2 nodes; that of a tetrahedron has 3 or 6");
}

// A load of faces is read where the scene can have it, which says it point by point.
TEST_F(Febio, ConstantLoadsOfAnotherHandAreRead) {
  const std::string good = TextOf(Data("febio_40.feb"));
  const auto read = [&](const std::string& faces, const std::string& loads) {
    std::ofstream(file()) << Replaced(
        Replaced(good, "<NodeSet name=\"Touchable\">",
                 "<Surface name=\"S\">" + faces + "</Surface><NodeSet name=\"Touchable\">"),
        "<Output>", "<Loads>" + loads + "</Loads><Output>");
    return vtkPalpateReadFEBio(file(), kNotSaid);
  };
  const std::string outward = "<tri3 id=\"1\">1,3,2</tri3>";
  const std::string inward = "<tri3 id=\"1\">1,2,3</tri3>";
  const std::string head = "<surface_load name=\"L\" surface=\"S\" type=\"";
  const auto pressure = [&](const std::string& value) {
    return head + "pressure\">" + value + "</surface_load>";
  };
  // mm and MPa.
  vtkPalpateFEBioModel model = read(outward, pressure("<pressure>0.5</pressure>"));
  EXPECT_TRUE(model.Warnings.empty());
  EXPECT_EQ(model.Scene.body.applied_pressure, (std::vector<double>{5e5, 5e5, 5e5, 0, 0}));
  model = read(inward, pressure("<linear>0</linear><pressure>0.5</pressure>"));
  EXPECT_EQ(model.Scene.body.applied_pressure, (std::vector<double>{-5e5, -5e5, -5e5, 0, 0}));
  model = read(outward, head +
                            "traction\"><scale>2</scale><traction>0,0.25,-1</traction>"
                            "</surface_load>");
  EXPECT_TRUE(model.Warnings.empty());
  ASSERT_EQ(model.Scene.body.applied_traction.size(), 5U);
  EXPECT_EQ(model.Scene.body.applied_traction[1], palpate::Vec3(0, 5e5, -2e6));
  EXPECT_EQ(model.Scene.body.applied_traction[4], palpate::Vec3(palpate::Vec3::Zero()));
  const auto grid = Read(file());
  EXPECT_TRUE(grid->GetPointData()->HasArray("AppliedTraction"));
  EXPECT_FALSE(grid->GetPointData()->HasArray("RestDisplacement"));

  const std::map<std::string, std::string> left_out = {
      {pressure("<pressure lc=\"1\">0.5</pressure>"), outward},
      {pressure("<pressure type=\"map\">p</pressure>"), outward},
      {pressure("<linear>1</linear><pressure>0.5</pressure>"), outward},
      {head + "fluidflux\"><value>1</value></surface_load>", outward},
      // Within the body, with a face that would be loaded too, and looking out and in.
      {pressure("<pressure>0.5</pressure>"), "<tri3 id=\"1\">2,3,5</tri3>"},
      {pressure("<pressure>0.25</pressure>"), outward + "<tri3 id=\"2\">1,2,5</tri3>"},
      {pressure("<pressure>0.375</pressure>"), outward + "<tri3 id=\"2\">1,3,5</tri3>"},
      {pressure("<pressure>0.125</pressure>"), outward + outward},
      // Two at the same points.
      {pressure("<pressure>1</pressure>") + pressure("<pressure>2</pressure>"), outward}};
  for (const auto& [load, faces] : left_out) {
    const std::vector<std::string> warnings = read(faces, load).Warnings;
    ASSERT_EQ(warnings.size(), 1U) << load;
    EXPECT_NE(warnings[0].find("it is left out"), std::string::npos) << warnings[0];
  }
  EXPECT_THROW((void)read(outward, pressure("<pressure>nan</pressure>")), palpate::InputError);
  EXPECT_THROW((void)read(outward, head + "traction\"><traction>1,2</traction></surface_load>"),
               palpate::InputError);
}

/// Calls a function with each number from 1 on, and gives what it says, one after the other.
template <class F>
std::string ForEachOf(int num, F&& text_of) {
  std::string text;
  for (int i = 1; i <= num; ++i) text += text_of(std::to_string(i));
  return text;
}

// As many sets, conditions, loads, parts and materials as there are nodes take no longer than as
// much of anything else: with a look at each set for each condition they would take minutes.
TEST_F(Febio, ManyOfAKindAreReadAtOnce) {
  constexpr int num = 10'000;
  // Some twenty times what each takes.
  constexpr double most_seconds = 4;
  Scene scene = Row(ElementOrder::linear, num);
  const auto read = [&](const std::string& text) {
    std::ofstream(file()) << text;
    const double begin = palpate::own_seconds();
    vtkPalpateFEBioModel model = vtkPalpateReadFEBio(file(), kNotSaid);
    EXPECT_LT(palpate::own_seconds() - begin, most_seconds);
    return model;
  };
  EXPECT_EQ(Write(vtkPalpateGridFromScene(scene), file()), "");
  const std::string good = TextOf(file());
  const auto with = [&](const std::string& sets, const std::string& after) {
    return Replaced(Replaced(good, "</Mesh>", sets + "</Mesh>"), "</febio_spec>",
                    after + "</febio_spec>");
  };
  const auto held = [&](const std::string& reference) {
    const std::string text = Replaced(
        good, "</Boundary>", ForEachOf(num, [&](const std::string& i) {
                               return "<bc type=\"zero displacement\" node_set=\"" + reference +
                                      (reference == "All" ? "" : i) + "\"><x_dof>1</x_dof></bc>";
                             }) + "</Boundary>");
    return Replaced(text, "</Mesh>",
                    "<NodeSet name=\"All\">1:" + std::to_string(num) + "</NodeSet>" +
                        ForEachOf(num,
                                  [](const std::string& i) {
                                    return "<NodeSet name=\"N" + i + "\">" + i + "</NodeSet>" +
                                           "<ElementSet name=\"E" + i + "\">" + i + "</ElementSet>";
                                  }) +
                        "</Mesh>");
  };
  for (const char* reference : {"N", "All", "@elem_set:E"}) {
    SCOPED_TRACE(reference);
    const Scene of = read(held(reference)).Scene;
    ASSERT_EQ(of.body.held_directions.size(), of.body.mesh.points.size());
    EXPECT_EQ(of.body.held_directions[num - 1].col(0), palpate::Vec3::UnitX());
    // The last points are in the last element, and in no other set.
    const bool has_last = std::string(reference) == "@elem_set:E";
    EXPECT_EQ(of.body.held_directions[num + 2].isZero(0), !has_last);
  }

  // One face for each: every other tetrahedron's first one is apart from the others.
  const std::vector<Index> faces = palpate::boundary_faces(scene.body.mesh);
  const int num_faces = static_cast<int>(faces.size() / 3);
  const auto surface = [&](const std::string& i) {
    const Index* face = &faces[3 * (std::stoul(i) - 1)];
    return "<Surface name=\"F" + i + "\"><tri3 id=\"1\">" + std::to_string(face[0] + 1) + ',' +
           std::to_string(face[1] + 1) + ',' + std::to_string(face[2] + 1) + "</tri3></Surface>";
  };
  const auto load = [](const std::string& i) {
    return "<surface_load surface=\"F" + i +
           "\" type=\"traction\"><traction>0,0,1</traction></surface_load>";
  };
  const vtkPalpateFEBioModel loaded = read(
      with(ForEachOf(num_faces, surface), "<Loads>" + ForEachOf(num_faces, load) + "</Loads>"));
  // Those that would load others, too, are left out.
  EXPECT_FALSE(
      palpate::faces_with(loaded.Scene.body.mesh, loaded.Scene.body.applied_traction).empty());
  EXPECT_EQ(
      loaded.Warnings.size() +
          palpate::faces_with(loaded.Scene.body.mesh, loaded.Scene.body.applied_traction).size() /
              3,
      static_cast<std::size_t>(num_faces));

  scene.organ.materials.clear();
  for (Index cell = 0; cell < num; ++cell) {
    scene.organ.materials.push_back(palpate::make_isotropic(Law::neo_hookean, 1000 + cell, 0.3));
    scene.body.material_of_cell[cell] = cell;
  }
  EXPECT_EQ(Write(vtkPalpateGridFromScene(scene), file("materials.feb")), "");
  EXPECT_EQ(read(TextOf(file("materials.feb"))).Scene.organ.materials, scene.organ.materials);

  std::string mesh;
  std::string materials;
  std::string domains;
  for (int i = 1; i <= num; ++i) {
    const std::string number = std::to_string(i);
    const Index* cell = &scene.body.mesh.cells[4 * (i - 1)];
    mesh += "<Elements type=\"tet4\" name=\"P" + number + "\"><elem id=\"" + number + "\">";
    for (int a = 0; a < 4; ++a) mesh += (a > 0 ? "," : "") + std::to_string(cell[a] + 1);
    mesh += "</elem></Elements>";
    materials += "<material id=\"" + number + "\" name=\"M" + number +
                 "\" type=\"neo-Hookean\"><E>" + std::to_string(1000 + i) +
                 "</E><v>0.3</v></material>";
    domains += "<SolidDomain name=\"P" + number + "\" mat=\"M" + number + "\"/>";
  }
  const auto between = [&](std::string text, const std::string& tag, const std::string& by) {
    const std::size_t begin = text.find('<' + tag);
    const std::string end = "</" + tag + '>';
    const std::size_t behind = text.rfind(end) + end.size();
    return text.replace(begin, behind - begin, by);
  };
  std::string parts = between(good, "Elements", mesh);
  parts = between(parts, "Material", "<Material>" + materials + "</Material>");
  parts = between(parts, "MeshDomains", "<MeshDomains>" + domains + "</MeshDomains>");
  const vtkPalpateFEBioModel of_parts = read(parts);
  EXPECT_EQ(of_parts.Regions.size(), static_cast<std::size_t>(num));
  EXPECT_EQ(of_parts.Scene.organ.materials.size(), static_cast<std::size_t>(num));
}

// kg/m³ is Pa s²/m², and the time is in s in all of them.
TEST_F(Febio, TheUnitOfDensityFollowsFromTheOthers) {
  for (const vtkPalpateFEBioUnits& units : vtkPalpateFEBioUnits::All()) {
    EXPECT_DOUBLE_EQ(units.Density, units.Pressure / (units.Length * units.Length)) << units.Name;
  }
}

// A set names nodes of the mesh: a short text does not stand for more than there are.
TEST_F(Febio, ASetNamesNoMoreThanTheMeshHas) {
  const std::string good = TextOf(Data("febio_40.feb"));
  const auto touchable = [&](const std::string& ids) {
    std::ofstream(file()) << Replaced(good, ">6</NodeSet>", ">" + ids + "</NodeSet>");
    return vtkPalpateReadFEBio(file(), kNotSaid).Scene.body.touchable;
  };
  EXPECT_EQ(touchable(" 1:3 , 6"), (std::vector<char>{1, 1, 1, 0, 1}));
  EXPECT_EQ(touchable("2:6:4,+1"), (std::vector<char>{1, 1, 0, 0, 1}));
  EXPECT_EQ(touchable("5:5"), (std::vector<char>{0, 0, 0, 1, 0}));
  constexpr const char* kLast = "9223372036854775807";
  const std::string many = [] {
    std::string text = "1";
    for (int i = 0; i < 5; ++i) text += ",1";
    return text;
  }();
  const std::map<std::string, std::string> refused = {
      {"1:1000000000000", "longer than the mesh: that has 5 nodes"},
      {"1:700000000", "longer than the mesh"},
      {std::string("1:") + kLast, "longer than the mesh"},
      {std::string("-") + kLast + ":" + kLast, "longer than the mesh"},
      {std::string("-9223372036854775808:") + kLast + ":4611686018427387904",
       "node -9223372036854775808, which is not among"},
      {std::string("1:2:") + kLast + ",9223372036854775806:" + kLast, "not among the nodes"},
      {"1:4", "node 4, which is not among the nodes"},
      {"1:3:0", "'1:3:0' where a range that goes up"},
      {"1:3:-1", "'1:3:-1' where a range that goes up"},
      {"3:1", "'3:1' where a range that goes up"},
      {"1:2:1:1", "'1:2:1:1' where a range first:last"},
      {"1:", "'1:' where a range first:last"},
      {"1:2x", "'1:2x' where a range first:last"},
      {"1;2", "'1;2' where numbers"},
      {"1,", "'1,' where numbers"},
      {"99999999999999999999", "where numbers"},
      {many, "more ids than the 5 nodes of the mesh"}};
  for (const auto& [ids, words] : refused) {
    const std::string message = error_of(Replaced(good, ">6</NodeSet>", ">" + ids + "</NodeSet>"));
    EXPECT_NE(message.find(words), std::string::npos) << ids << ": " << words << "\n" << message;
  }
}

// What a message repeats of a file obeys nobody.
TEST_F(Febio, TextOfTheFileIsPrintable) {
  const std::string good = TextOf(Data("febio_40.feb"));
  const std::map<std::string, std::string> replaced = {
      {"type=\"neo-Hookean\"", "type=\"\xc2\x9b\xe2\x80\xae\""},
      {"mm-N-s", "\xc2\x9b"},
      {"<E>0.006</E>", "<E>\xc2\x9b</E>"},
      {"<E>0.006</E>", "<E type=\"map\">\xc2\x9b</E>"},
      {"@surface:Base\"", "\xc2\x9b\""},
      {"mat=\"Nodule\"", "mat=\"\xc2\x9b\""},
      {"type=\"tet4\"", "type=\"\xc2\x9b\""},
      {"version=\"4.0\"", "version=\"\xc2\x9b\""},
      {"type=\"solid\"", "type=\"\xc2\x9b\""},
      {"<Output>", "<Other><\xc3\xa9 name=\"\xc2\x9b\"/></Other><Output>"}};
  for (const auto& [what, by] : replaced) {
    const std::string message = error_of(Replaced(good, what, by));
    EXPECT_NE(message, "") << by;
    EXPECT_EQ(message.find("\xc2\x9b"), std::string::npos) << message;
    EXPECT_EQ(message.find("\xe2\x80\xae"), std::string::npos) << message;
  }
  const std::string long_text(100000, 'x');
  EXPECT_LT(error_of(Replaced(good, "mm-N-s", long_text)).size(), 1000U);
}

TEST_F(Febio, APipeIsRefusedAndNotWaitedFor) {
  ASSERT_EQ(mkfifo(file("pipe.feb").c_str(), 0600), 0);
  EXPECT_NE(error_of_file(file("pipe.feb")).find("is a pipe"), std::string::npos);
  EXPECT_NE(error_of_file("/dev/zero").find("is a pipe, a device"), std::string::npos);
  const auto grid = vtkPalpateGridFromScene(Row(ElementOrder::linear, 2));
  EXPECT_NE(Write(grid, file("pipe.feb")).find("is a pipe"), std::string::npos);
}

TEST_F(Febio, OfSpecification30) {
  const vtkPalpateFEBioModel model = vtkPalpateReadFEBio(Data("febio_30.feb"), kNotSaid);
  EXPECT_EQ(
      model.Scene.organ.materials[0],
      palpate::with_formulation(palpate::make_material(Law::ogden, {50000, 631, -24, 0, 0, 50, 3}),
                                Formulation::displacement));
  EXPECT_EQ(model.Scene.body.fixed, (std::vector<char>{1, 1, 1, 0}));
  // Where there is no set of that name, the corners of the surface that are free.
  EXPECT_EQ(model.Scene.body.touchable, (std::vector<char>{0, 0, 0, 1}));
  ASSERT_EQ(model.Warnings.size(), 2U);
  EXPECT_EQ(model.Warnings[0].rfind("<surface_load name=\"Pressure1\">", 0), 0U);
  EXPECT_EQ(model.Warnings[1].rfind("<bc name=\"Pull\">", 0), 0U);
}

TEST_F(Febio, OfSpecification25WithUnitsThatAreSaid) {
  const vtkPalpateFEBioModel model = vtkPalpateReadFEBio(Data("febio_25.feb"), kMillimetreNewton);
  const Scene& scene = model.Scene;
  EXPECT_EQ(scene.body.mesh.order, ElementOrder::quadratic);
  EXPECT_EQ(scene.organ.materials[0], palpate::make_isotropic(Law::st_venant_kirchhoff, 5e6, 0.3));
  EXPECT_EQ(scene.body.fixed, (std::vector<char>{1, 1, 1, 0, 1, 1, 1, 0, 0, 0}));
  // Each midside node is in the middle of the edge that VTK means by its place.
  constexpr int edges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  const Index* nodes = scene.body.mesh.cell(0);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(scene.body.mesh.points[nodes[4 + i]], (scene.body.mesh.points[nodes[edges[i][0]]] +
                                                     scene.body.mesh.points[nodes[edges[i][1]]]) /
                                                        2);
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
  expect("<pressure_model>Abaqus", "<pressure_model>Simo", "pressure_model 'Simo'");
  expect("<E>0.006</E>", "<E lc=\"1\">0.006</E>", "follows a load curve");
  expect("<E>0.006</E>", "<E>a+b</E>", "'a+b' where one number is due");
  expect("<E>0.006</E>", "<E>0.006 MPa</E>", "'0.006 MPa' where one number is due");
  expect("<E>0.006</E>", "<E></E>", "'' where one number is due");
  expect("<E>0.006</E>", "<E>0.006</E><E>0.006</E>", "has E twice");
  expect("<density>1e-09", "<density lc=\"1\">1e-09", "follows a load curve");
  expect("<density>1e-09", "<density>-1", "density (Density) is -1");
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
  expect("@surface:Base\"", "Nowhere\"", "no set of that name");
  expect("mat=\"Nodule\"", "mat=\"None\"", "no material 'None'");
  expect("<SolidDomain name=\"Part2\"", "<SolidDomain name=\"Part3\"",
         "no <SolidDomain name=\"Part2\">");
  expect("<node id=\"6\"", "<node id=\"4:6\"", "'4:6' where one number is due");
  expect("<elem id=\"7\"", "<elem id=\"7x\"", "'7x' where one number is due");
  expect("2,3,5,6", "2:3,5,6", "'2:3,5,6' where numbers");
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
  scene.organ.materials[0] = palpate::make_isotropic(Law::neo_hookean, 1000, 0.49);
  std::string message = Write(vtkPalpateGridFromScene(scene), file());
  EXPECT_NE(message.find("too stiff"), std::string::npos) << message;
  ExpectSame(vtkPalpateReadFEBio(file(), kNotSaid).Scene, scene);
  scene = Row(ElementOrder::quadratic, 2);
  scene.body.touchable.assign(scene.body.touchable.size(), 0);
  message = Write(vtkPalpateGridFromScene(scene), file());
  EXPECT_NE(message.find("No point may be touched"), std::string::npos) << message;
}
}  // namespace
