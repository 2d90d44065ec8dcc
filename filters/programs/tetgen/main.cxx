// SPDX-License-Identifier: BSD-3-Clause
// palpate-tetgen: TetGen in a program of its own, where its abort, crash or hang harms nobody.
//
// This file is under the licence above. The program links TetGen, which is under the GNU Affero
// General Public License, version 3 or later: the program as a whole is distributed under that.
//
//   palpate-tetgen --ratio R [--volume V] [--preserve] < surface.vtp > body.vtu
//   palpate-tetgen --ratio R --region-volume V … < surface.vtp 3< region.vti > body.vtu
//
// Input: VTK XML polydata, triangles that bound the body, with the cell array `Marker` (int > 0).
// It may have the field arrays `SeedPoint` (3 components), `SeedNumber` (int > 0) and `SeedVolume`,
// a tuple for each: the part of space around the point has that number, and its tetrahedra are no
// larger than the volume, if that is greater than 0. Parts without a seed have other numbers.
// Output: a VTK XML unstructured grid of the tetrahedra, positively oriented in VTK's sense, their
// `Marker` the region of space that they lie in (numbered by TetGen), and of the triangles on the
// bounding surface, their `Marker` that of the triangle of the input that they lie in. The points
// of the input come first, unchanged.
//
//   --ratio R          largest ratio of circumscribed radius to shortest edge
//   --volume V         largest volume of a tetrahedron
//   --region-volume V  the same where the point array `Region` of the image on file descriptor 3 is
//                      not positive
//   --preserve         leave the triangles of the surface as they are
//
// What TetGen prints goes to standard error. The exit code is 0, or TetGen's own (1 memory,
// 2 internal error, 3 self-intersection, 4 small feature, 5 close facets, 10 bad input), or 64 for
// bad arguments, 65 for bad data.

#include <tetgen.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iostream>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>

#include "program/exit_codes.h"
#include "program/limit_process.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGrid.h"
#include "vtkXMLImageDataReader.h"
#include "vtkXMLPolyDataReader.h"
#include "vtkXMLUnstructuredGridWriter.h"

namespace
{
using vtkPalpateExitCode::BadArguments;
using vtkPalpateExitCode::BadData;

constexpr int RegionDescriptor = 3;

struct Options
{
  double Ratio = 0;
  double Volume = 0;
  double RegionVolume = 0;
  bool Preserve = false;
};

/// A switch for TetGen, which reads no exponents of either sign everywhere.
std::string Digits(double value)
{
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), "%.30f", value);
  return text.data();
}

Options ReadOptions(int argc, char** argv)
{
  Options options;
  const std::map<std::string, double*> numbers = { { "--ratio", &options.Ratio },
    { "--volume", &options.Volume }, { "--region-volume", &options.RegionVolume } };
  for (int i = 1; i < argc; ++i)
  {
    const std::string name = argv[i];
    if (name == "--preserve")
    {
      options.Preserve = true;
    }
    else if (const auto number = numbers.find(name); number != numbers.end() && i + 1 < argc)
    {
      *number->second = std::strtod(argv[++i], nullptr);
    }
    else
    {
      throw std::invalid_argument("unknown argument " + name);
    }
  }
  const auto volume = [](double value) { return value >= 0 && std::isfinite(value); };
  if (!(options.Ratio >= 1) || !volume(options.Volume) || !volume(options.RegionVolume))
  {
    throw std::invalid_argument("--ratio must be at least 1, volumes at least 0");
  }
  return options;
}

/// To a box of about unit size about the origin and back: TetGen's tolerances, and the digits of
/// its switches, then fit bodies in any unit and anywhere.
class Frame
{
public:
  explicit Frame(vtkPoints* points)
  {
    double bounds[6];
    points->GetBounds(bounds);
    double longest = 0;
    for (int i = 0; i < 3; ++i)
    {
      Centre[i] = (bounds[2 * i] + bounds[2 * i + 1]) / 2;
      longest = std::max(longest, bounds[2 * i + 1] - bounds[2 * i]);
    }
    // A power of two scales without rounding.
    Scale = longest > 0 ? std::exp2(-std::ceil(std::log2(longest))) : 1;
  }
  void In(const double x[3], double* y) const
  {
    for (int i = 0; i < 3; ++i)
    {
      y[i] = (x[i] - Centre[i]) * Scale;
    }
  }
  void Out(const double* y, double x[3]) const
  {
    for (int i = 0; i < 3; ++i)
    {
      x[i] = y[i] / Scale + Centre[i];
    }
  }
  double VolumeIn(double volume) const { return volume * Scale * Scale * Scale; }

private:
  double Centre[3];
  double Scale;
};

std::string ReadAll(int file)
{
  std::string text;
  std::array<char, 1 << 16> buffer;
  ssize_t count;
  while ((count = read(file, buffer.data(), buffer.size())) > 0)
  {
    text.append(buffer.data(), static_cast<std::size_t>(count));
  }
  if (count < 0)
  {
    throw std::runtime_error(std::string("cannot read the input: ") + std::strerror(errno));
  }
  return text;
}

template <class Reader>
auto ReadData(int file)
{
  vtkNew<Reader> reader;
  reader->ReadFromInputStringOn();
  reader->SetInputString(ReadAll(file));
  reader->Update();
  return vtk::MakeSmartPointer(reader->GetOutput());
}

vtkSmartPointer<vtkPolyData> ReadSurface()
{
  auto surface = ReadData<vtkXMLPolyDataReader>(STDIN_FILENO);
  if (!surface || surface->GetNumberOfPolys() == 0 ||
    !vtkIntArray::SafeDownCast(surface->GetCellData()->GetArray("Marker")))
  {
    throw std::runtime_error(
      "standard input holds no VTK polydata with triangles and the cell array Marker");
  }
  return surface;
}

/// What is known of parts of space beforehand.
struct Seeds
{
  vtkDataArray* Points;
  vtkDataArray* Numbers;
  vtkDataArray* Volumes;
  /// The bounds by number, in TetGen's frame.
  std::map<int, double> VolumeOf;

  Seeds(vtkPolyData* surface, const Frame& frame)
    : Points(surface->GetFieldData()->GetArray("SeedPoint"))
    , Numbers(surface->GetFieldData()->GetArray("SeedNumber"))
    , Volumes(surface->GetFieldData()->GetArray("SeedVolume"))
  {
    if (!Points && !Numbers && !Volumes)
    {
      return;
    }
    if (!Points || !Numbers || !Volumes || Points->GetNumberOfComponents() != 3 ||
      Numbers->GetNumberOfTuples() != Count() || Volumes->GetNumberOfTuples() != Count())
    {
      throw std::runtime_error(
        "the field arrays SeedPoint, SeedNumber and SeedVolume do not belong together");
    }
    for (vtkIdType i = 0; i < Count(); ++i)
    {
      if (Volumes->GetTuple1(i) > 0)
      {
        VolumeOf[static_cast<int>(Numbers->GetTuple1(i))] = frame.VolumeIn(Volumes->GetTuple1(i));
      }
    }
  }

  vtkIdType Count() const { return Points ? Points->GetNumberOfTuples() : 0; }

  void Fill(const Frame& frame, double factor, tetgenio& in) const
  {
    constexpr int size = 5; // the place, the number, the bound
    in.numberofregions = static_cast<int>(Count());
    in.regionlist = new REAL[size * static_cast<std::size_t>(Count())];
    for (vtkIdType i = 0; i < Count(); ++i)
    {
      REAL* entry = in.regionlist + size * i;
      frame.In(Points->GetTuple3(i), entry);
      entry[3] = Numbers->GetTuple1(i);
      const auto bound = VolumeOf.find(static_cast<int>(entry[3]));
      entry[4] = bound == VolumeOf.end() ? -1 : factor * bound->second;
    }
  }
};

void FillInput(vtkPolyData* surface, const Frame& frame, tetgenio& in)
{
  in.numberofpoints = static_cast<int>(surface->GetNumberOfPoints());
  in.pointlist = new REAL[3 * static_cast<std::size_t>(in.numberofpoints)];
  for (int i = 0; i < in.numberofpoints; ++i)
  {
    double x[3];
    surface->GetPoint(i, x);
    frame.In(x, in.pointlist + 3 * static_cast<std::size_t>(i));
  }

  auto* markers = vtkIntArray::SafeDownCast(surface->GetCellData()->GetArray("Marker"));
  in.numberoffacets = static_cast<int>(surface->GetNumberOfPolys());
  in.facetlist = new tetgenio::facet[in.numberoffacets];
  in.facetmarkerlist = new int[in.numberoffacets];
  vtkNew<vtkIdList> corners;
  for (int i = 0; i < in.numberoffacets; ++i)
  {
    surface->GetCellPoints(i, corners);
    auto& facet = in.facetlist[i];
    tetgenio::init(&facet);
    facet.numberofpolygons = 1;
    facet.polygonlist = new tetgenio::polygon[1];
    facet.polygonlist[0].numberofvertices = 3;
    facet.polygonlist[0].vertexlist = new int[3];
    for (int corner = 0; corner < 3; ++corner)
    {
      facet.polygonlist[0].vertexlist[corner] = static_cast<int>(corners->GetId(corner));
    }
    in.facetmarkerlist[i] = markers->GetValue(i);
  }
}

/// A part of space, as the zero level of a function sampled on a grid.
class Region
{
public:
  explicit Region(vtkImageData* image)
    : Image(image)
    , Values(image->GetPointData()->GetArray("Region"))
  {
    if (!Values)
    {
      throw std::runtime_error("the image of the region has no point array Region");
    }
  }

  bool Contains(const double x[3]) const
  {
    int index[3];
    double fraction[3];
    if (!Image->ComputeStructuredCoordinates(x, index, fraction))
    {
      return false;
    }
    double value = 0;
    for (int corner = 0; corner < 8; ++corner)
    {
      int at[3];
      double weight = 1;
      for (int axis = 0; axis < 3; ++axis)
      {
        const int up = (corner >> axis) & 1;
        at[axis] = index[axis] + up;
        weight *= up ? fraction[axis] : 1 - fraction[axis];
      }
      if (weight > 0)
      {
        value += weight * Values->GetTuple1(Image->ComputePointId(at));
      }
    }
    return value <= 0;
  }

private:
  vtkSmartPointer<vtkImageData> Image;
  vtkDataArray* Values;
};

double Volume(const double* a, const double* b, const double* c, const double* d)
{
  double u[3], v[3], w[3];
  vtkMath::Subtract(a, d, u);
  vtkMath::Subtract(b, d, v);
  vtkMath::Subtract(c, d, w);
  return std::abs(vtkMath::Determinant3x3(u, v, w)) / 6;
}

/// How large tetrahedra may be where. Volumes are those of TetGen's frame.
struct Sizing
{
  const Frame* Space;
  const Region* Part; ///< null: everywhere alike
  double PartVolume;

  /// Whether the tetrahedron is too large and reaches into the region: with any of a lattice of
  /// points about as far apart as the tetrahedra wanted there.
  bool TooLarge(const double* a, const double* b, const double* c, const double* d) const
  {
    const double volume = Volume(a, b, c, d);
    if (!Part || volume <= PartVolume)
    {
      return false;
    }
    constexpr double finest = 12;
    const int n = 1 + static_cast<int>(std::min(std::ceil(std::cbrt(volume / PartVolume)), finest));
    for (int i = 0; i <= n; ++i)
    {
      for (int j = 0; j <= n - i; ++j)
      {
        for (int k = 0; k <= n - i - j; ++k)
        {
          double y[3], x[3];
          for (int axis = 0; axis < 3; ++axis)
          {
            y[axis] = (i * a[axis] + j * b[axis] + k * c[axis] + (n - i - j - k) * d[axis]) / n;
          }
          Space->Out(y, x);
          if (Part->Contains(x))
          {
            return true;
          }
        }
      }
    }
    return false;
  }
};

/// TetGen's callback takes a plain function, without data.
const Sizing* CurrentSizing = nullptr;

bool TooLarge(REAL* a, REAL* b, REAL* c, REAL* d, REAL*, REAL)
{
  return CurrentSizing->TooLarge(a, b, c, d);
}

std::array<const double*, 4> Corners(const tetgenio& mesh, std::size_t tetrahedron)
{
  std::array<const double*, 4> corners;
  for (std::size_t j = 0; j < 4; ++j)
  {
    const int point = mesh.tetrahedronlist[tetrahedron * mesh.numberofcorners + j];
    corners[j] = mesh.pointlist + 3 * static_cast<std::size_t>(point);
  }
  return corners;
}

/// TetGen's number of the part of space that a tetrahedron is in.
int Number(const tetgenio& mesh, std::size_t tetrahedron)
{
  return static_cast<int>(
    std::lround(mesh.tetrahedronattributelist[tetrahedron * mesh.numberoftetrahedronattributes]));
}

/// By how much the worst tetrahedron exceeds its bound, at least 1.
double Excess(const tetgenio& mesh, const Sizing& wanted, const Seeds& seeds, double wanted_volume)
{
  double excess = 1;
  for (int i = 0; i < mesh.numberoftetrahedra; ++i)
  {
    const auto p = Corners(mesh, static_cast<std::size_t>(i));
    const double volume = Volume(p[0], p[1], p[2], p[3]);
    if (wanted_volume > 0)
    {
      excess = std::max(excess, volume / wanted_volume);
    }
    const auto bound = seeds.VolumeOf.find(Number(mesh, static_cast<std::size_t>(i)));
    if (bound != seeds.VolumeOf.end())
    {
      excess = std::max(excess, volume / bound->second);
    }
    if (wanted.TooLarge(p[0], p[1], p[2], p[3]))
    {
      excess = std::max(excess, volume / wanted.PartVolume);
    }
  }
  return excess;
}

std::string Switches(const Options& options, double volume)
{
  // J keeps all points, so that those of the input stay first. A: a number for each part of space
  // that the surface encloses.
  std::string switches = "AJq" + Digits(options.Ratio);
  if (options.Preserve)
  {
    switches += "Y";
  }
  if (volume > 0)
  {
    switches += "a" + Digits(volume);
  }
  return switches;
}

/// Refines what reaches into the region and is larger than its bound still. The callback only asks
/// for a point, which TetGen 1.6 refuses where it would make a short edge, as beside a region that
/// is smaller than the tetrahedra around it; a bound of a tetrahedron's own it heeds.
std::unique_ptr<tetgenio> RefineRest(
  std::unique_ptr<tetgenio> mesh, const Options& options, const Sizing& wanted)
{
  // What reaches into the region is halved about three times, so that what is beside it is not
  // refined as well.
  constexpr double step = 8;
  constexpr int most_rounds = 30;
  for (int round = 0; round < most_rounds; ++round)
  {
    const auto number = static_cast<std::size_t>(mesh->numberoftetrahedra);
    delete[] mesh->tetrahedronvolumelist;
    mesh->tetrahedronvolumelist = new REAL[number];
    bool all_fit = true;
    for (std::size_t i = 0; i < number; ++i)
    {
      const auto p = Corners(*mesh, i);
      const bool fits = !wanted.TooLarge(p[0], p[1], p[2], p[3]);
      mesh->tetrahedronvolumelist[i] =
        fits ? -1 : std::max(Volume(p[0], p[1], p[2], p[3]) / step, wanted.PartVolume);
      all_fit = all_fit && fits;
    }
    if (all_fit)
    {
      break;
    }
    auto finer = std::make_unique<tetgenio>();
    std::string switches = "ra" + Switches(options, 0);
    tetrahedralize(switches.data(), mesh.get(), finer.get());
    const bool is_finer = finer->numberofpoints > mesh->numberofpoints;
    mesh = std::move(finer);
    if (!is_finer)
    {
      break;
    }
  }
  return mesh;
}

/// TetGen's last step, which improves shapes, makes a few tetrahedra larger than their bound: then
/// it has to start again with a lower one. Beside triangles that are to stay as they are, a bound
/// may be out of reach.
std::unique_ptr<const tetgenio> Mesh(
  vtkPolyData* surface, const Options& options, const Frame& frame, const Region* region)
{
  constexpr int most_trials = 5;
  constexpr double rounding = 1e-9;
  constexpr double margin = 0.98;
  constexpr double least_factor = 0.5;
  const double volume = frame.VolumeIn(options.Volume);
  const Sizing wanted = { &frame, region, frame.VolumeIn(options.RegionVolume) };
  const Seeds seeds(surface, frame);
  double factor = 1;
  for (int trial = 1;; ++trial)
  {
    const Sizing sizing = { &frame, region, factor * wanted.PartVolume };
    CurrentSizing = &sizing;
    tetgenio in;
    FillInput(surface, frame, in);
    seeds.Fill(frame, factor, in);
    if (region)
    {
      in.tetunsuitable = TooLarge;
    }
    auto out = std::make_unique<tetgenio>();
    std::string switches = "p" + Switches(options, factor * volume);
    if (!seeds.VolumeOf.empty())
    {
      switches += "a"; // of each part its own bound
    }
    tetrahedralize(switches.data(), &in, out.get());
    const double excess = Excess(*out, wanted, seeds, volume);
    if (excess <= 1 + rounding || options.Preserve)
    {
      return out;
    }
    if (trial == most_trials)
    {
      return region ? RefineRest(std::move(out), options, wanted) : std::move(out);
    }
    factor = std::max(least_factor, factor * margin / excess);
  }
}

vtkSmartPointer<vtkUnstructuredGrid> ToGrid(
  const tetgenio& out, vtkPolyData* input, const Frame& frame)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(out.numberofpoints);
  for (int i = 0; i < out.numberofpoints; ++i)
  {
    double x[3];
    if (i < input->GetNumberOfPoints())
    {
      input->GetPoint(i, x);
    }
    else
    {
      frame.Out(out.pointlist + 3 * static_cast<std::size_t>(i), x);
    }
    points->SetPoint(i, x);
  }

  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  grid->SetPoints(points);
  grid->Allocate(out.numberoftetrahedra + out.numberoftrifaces);
  vtkNew<vtkIntArray> markers;
  markers->SetName("Marker");
  for (int i = 0; i < out.numberoftetrahedra; ++i)
  {
    const int* corner = out.tetrahedronlist + static_cast<std::size_t>(i) * out.numberofcorners;
    vtkIdType ids[4] = { corner[0], corner[1], corner[2], corner[3] };
    grid->InsertNextCell(VTK_TETRA, 4, ids);
    markers->InsertNextValue(Number(out, static_cast<std::size_t>(i)));
  }
  for (int i = 0; i < out.numberoftrifaces; ++i)
  {
    const int* corner = out.trifacelist + 3 * static_cast<std::size_t>(i);
    vtkIdType ids[3] = { corner[0], corner[1], corner[2] };
    grid->InsertNextCell(VTK_TRIANGLE, 3, ids);
    markers->InsertNextValue(out.trifacemarkerlist[i]);
  }
  grid->GetCellData()->AddArray(markers);
  return grid;
}

void WriteGrid(vtkUnstructuredGrid* grid, int file)
{
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetInputData(grid);
  // Not appended: recent releases of Expat make VTK's reader refuse that.
  writer->SetDataModeToBinary();
  writer->SetCompressorTypeToNone();
  writer->WriteToOutputStringOn();
  writer->Write();
  const std::string text = writer->GetOutputString();
  std::size_t written = 0;
  while (written < text.size())
  {
    const ssize_t count = write(file, text.data() + written, text.size() - written);
    if (count <= 0)
    {
      throw std::runtime_error(std::string("cannot write the mesh: ") + std::strerror(errno));
    }
    written += static_cast<std::size_t>(count);
  }
}

const char* Meaning(int code)
{
  switch (code)
  {
    case 1:
      return "out of memory";
    case 2:
      return "internal error";
    case 3:
      return "the surface crosses itself";
    case 4:
      return "a feature of the surface is too small";
    case 5:
      return "two facets of the surface are too close to each other";
    case 10:
      return "bad input";
    default:
      return "unknown error";
  }
}
}

int main(int argc, char** argv)
{
  LimitProcess();
  // TetGen prints to standard output, which is the mesh's here.
  const int output = dup(STDOUT_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  setvbuf(stdout, nullptr, _IOLBF, 0);
  try
  {
    const Options options = ReadOptions(argc, argv);
    const auto surface = ReadSurface();
    const Frame frame(surface->GetPoints());
    std::optional<Region> region;
    if (options.RegionVolume > 0)
    {
      region.emplace(ReadData<vtkXMLImageDataReader>(RegionDescriptor));
    }
    const auto mesh = Mesh(surface, options, frame, region ? &*region : nullptr);
    WriteGrid(ToGrid(*mesh, surface, frame), output);
    return 0;
  }
  catch (int code)
  {
    std::cout << "TetGen stopped: " << Meaning(code) << "." << std::endl;
    return code > 0 && code < BadArguments ? code : 2;
  }
  catch (const std::bad_alloc&)
  {
    std::cout << "TetGen stopped: out of memory." << std::endl;
    return 1;
  }
  catch (const std::invalid_argument& error)
  {
    std::cerr << "palpate-tetgen: " << error.what() << std::endl;
    return BadArguments;
  }
  catch (const std::exception& error)
  {
    std::cerr << "palpate-tetgen: " << error.what() << std::endl;
    return BadData;
  }
}
