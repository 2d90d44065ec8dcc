// SPDX-License-Identifier: BSD-3-Clause
// palpate-image: ITK's readers of images in a program of its own, where a damaged file that brings
// them down harms nobody, and where none of ITK is loaded into ParaView.
//
//   palpate-image FILE > header                     its header
//   palpate-image --voxels FILE > header 3> voxels  its header and its voxels
//
// FILE is NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd) or NIfTI (.nii, .nii.gz). The header is lines
// of a word and what it is about:
//
//   size I J K         voxels along each axis
//   origin X Y Z       the middle of the first voxel, in the file's unit
//   axis X Y Z         three times: from a voxel to the next along the first, second, third axis
//   components N       values of a voxel
//   oriented YES       1: the file says where its axes point to; 0: it does not
//   unit NAME          where the file names one
//   key NAME VALUE     what the file says of segments, such as `key Segment0_Name liver`
//   whole YES          with --voxels. 1: each value is a whole number of 32 bits to within 0.001,
//                      and the voxels are int32; 0: they are doubles
//
// Places are those of ITK: x to the left of the person, y to the back, z to the head (LPS). The
// values of a voxel are side by side, the first axis is the fastest.
//
// The exit code is 0, or 64 for bad arguments, or 65 for bad data: then the header is what is
// wrong.

#include <NrrdIO.h>
#include <itkMetaDataObject.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <zlib.h>

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "program/exit_codes.h"
#include "program/limit_process.h"

namespace
{
using vtkPalpateExitCode::BadArguments;
using vtkPalpateExitCode::BadData;

constexpr int VoxelDescriptor = 3;
/// More values are refused.
constexpr double MostValues = 1e9;
/// A value this near to a whole number is that number.
constexpr double LabelTolerance = 1e-3;
constexpr int Dimension = 3;

using Vector = std::array<double, Dimension>;

struct Frame
{
  Vector Origin{};
  std::array<Vector, Dimension> Axes{};
};

bool EndsWith(const std::string& text, const std::string& end)
{
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

itk::ImageIOBase::Pointer ReaderOf(const std::string& file)
{
  std::string name = file;
  std::transform(name.begin(), name.end(), name.begin(),
    [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  if (EndsWith(name, ".nrrd") || EndsWith(name, ".nhdr"))
  {
    return itk::NrrdImageIO::New().GetPointer();
  }
  if (EndsWith(name, ".mha") || EndsWith(name, ".mhd"))
  {
    return itk::MetaImageIO::New().GetPointer();
  }
  if (EndsWith(name, ".nii") || EndsWith(name, ".nii.gz"))
  {
    return itk::NiftiImageIO::New().GetPointer();
  }
  throw std::runtime_error("it is none of .nrrd, .nhdr, .mha, .mhd, .nii and .nii.gz");
}

/// On one line, without what only the developers of ITK understand.
std::string TextOf(const itk::ExceptionObject& error)
{
  std::istringstream words(error.GetDescription());
  std::string text;
  for (std::string word; words >> word;)
  {
    text += (text.empty() ? "" : " ") + word;
  }
  // NRRD's part tells from the general to the particular, MetaImage's begins with an address.
  for (const char* before : { "[nrrd] ", "): ", "ITK ERROR: " })
  {
    const auto found = text.rfind(before);
    if (found != std::string::npos)
    {
      text.erase(0, found + std::strlen(before));
    }
  }
  if (text.find("orthonormal") != std::string::npos)
  {
    return "the axes of its voxels are not at right angles, or its sform does not fit the sizes of "
           "its voxels (ITK says: " +
      text + "). Resample it in the program that made it, and save it again";
  }
  return "ITK says: " + text;
}

std::string StringOf(const itk::MetaDataDictionary& dictionary, const std::string& key)
{
  std::string value;
  itk::ExposeMetaData(dictionary, key, value);
  return value;
}

/// What leads from a space of NRRD to LPS; of others nobody knows.
std::optional<Vector> ToLps(int space)
{
  switch (space)
  {
    case nrrdSpaceLeftPosteriorSuperior:
    case nrrdSpaceLeftPosteriorSuperiorTime:
      return Vector{ 1, 1, 1 };
    case nrrdSpaceRightAnteriorSuperior:
    case nrrdSpaceRightAnteriorSuperiorTime:
      return Vector{ -1, -1, 1 };
    case nrrdSpaceLeftAnteriorSuperior:
    case nrrdSpaceLeftAnteriorSuperiorTime:
      return Vector{ 1, -1, 1 };
    default:
      return std::nullopt;
  }
}

/// What NRRD says in its header and ITK does not tell, or tells otherwise: it turns what is in LAS
/// by 180° about z.
struct NrrdHeader
{
  std::string Unit;
  int Space = nrrdSpaceUnknown;
  bool IsDetached = false;    ///< the voxels are in other files
  bool IsRaw = false;         ///< they are neither compressed nor text
  std::optional<Frame> Place; ///< where the header has directions, in LPS if it can be

  explicit NrrdHeader(const std::string& file)
  {
    const std::unique_ptr<Nrrd, Nrrd* (*)(Nrrd*)> nrrd(nrrdNew(), nrrdNuke);
    const std::unique_ptr<NrrdIoState, NrrdIoState* (*)(NrrdIoState*)> state(
      nrrdIoStateNew(), nrrdIoStateNix);
    nrrdIoStateSet(state.get(), nrrdIoStateSkipData, 1);
    if (nrrdLoad(nrrd.get(), file.c_str(), state.get()) != 0)
    {
      std::free(biffGetDone(NRRD));
      throw std::runtime_error("its header is damaged");
    }
    Space = nrrd->space;
    IsDetached = state->detachedHeader || state->dataFNArr->len > 0 || state->dataFNFormat;
    IsRaw = state->encoding == nrrdEncodingRaw;
    Place = PlaceOf(*nrrd);
    for (const char* unit : nrrd->spaceUnits)
    {
      if (unit && *unit)
      {
        Unit = unit;
        break;
      }
    }
  }

private:
  static std::optional<Frame> PlaceOf(const Nrrd& nrrd)
  {
    const Vector sign = ToLps(nrrd.space).value_or(Vector{ 1, 1, 1 });
    Frame place;
    std::size_t axes = 0;
    for (unsigned axis = 0; nrrd.spaceDim >= Dimension && axis < nrrd.dim; ++axis)
    {
      const double* direction = nrrd.axis[axis].spaceDirection;
      if (std::isfinite(direction[0]) && axes < Dimension)
      {
        for (int c = 0; c < Dimension; ++c)
        {
          place.Axes[axes][c] = sign[c] * direction[c];
        }
        ++axes;
      }
    }
    for (int c = 0; c < Dimension; ++c)
    {
      // An origin that is not told is not a number.
      const double origin = nrrd.spaceOrigin[c];
      place.Origin[c] = std::isfinite(origin) ? sign[c] * origin : 0;
    }
    return axes == Dimension ? std::make_optional(place) : std::nullopt;
  }
};

[[noreturn]] void ThrowCutOff(double there, double due)
{
  std::ostringstream text;
  text.precision(12);
  text << "it is cut off, or its header is damaged: it has " << there << " bytes of the " << due
       << " that the header tells of";
  throw std::runtime_error(text.str());
}

double SizeOf(const std::string& file)
{
  struct stat status;
  if (stat(file.c_str(), &status) != 0)
  {
    throw std::runtime_error("the file of its voxels, " + file + ": " + std::strerror(errno));
  }
  return static_cast<double>(status.st_size);
}

/// NRRD's reader complains itself, but after it has taken the memory.
void CheckNrrd(const std::string& file, const NrrdHeader& header, double bytes)
{
  // What deflate makes of zeros.
  constexpr double most_compressed = 1032;
  const double least = header.IsRaw ? bytes : bytes / most_compressed;
  if (!header.IsDetached && SizeOf(file) < least)
  {
    ThrowCutOff(SizeOf(file), least);
  }
}

[[noreturn]] void ThrowDamaged()
{
  throw std::runtime_error("its compressed voxels are damaged");
}

/// How many bytes a stream of deflate holds, from where it stands; it is left where it has more
/// than are due.
double InflatedSize(std::istream& stream, double due)
{
  z_stream state{};
  constexpr int zlib_or_gzip = 32 + MAX_WBITS;
  if (inflateInit2(&state, zlib_or_gzip) != Z_OK)
  {
    throw std::bad_alloc();
  }
  constexpr std::size_t most = 1 << 18;
  std::vector<char> packed(most), part(most);
  double there = 0;
  int status = Z_OK;
  while (status == Z_OK && there <= due)
  {
    if (state.avail_in == 0)
    {
      stream.read(packed.data(), most);
      state.next_in = reinterpret_cast<Bytef*>(packed.data());
      state.avail_in = static_cast<uInt>(stream.gcount());
    }
    state.next_out = reinterpret_cast<Bytef*>(part.data());
    state.avail_out = most;
    status = inflate(&state, Z_NO_FLUSH); // without input an error, which ends this
    there += static_cast<double>(most - state.avail_out);
  }
  inflateEnd(&state);
  if (status != Z_OK && status != Z_STREAM_END && (status != Z_BUF_ERROR || there >= due))
  {
    ThrowDamaged();
  }
  return there;
}

/// The reader of MetaImage takes what is missing for zeros.
void CheckMetaImage(const std::string& file, double bytes)
{
  std::ifstream stream(file, std::ios::binary);
  std::map<std::string, std::string> header;
  for (std::string line; header.count("ElementDataFile") == 0 && std::getline(stream, line);)
  {
    std::istringstream words(line);
    std::string key, equals;
    words >> key >> equals >> header[key];
  }
  const std::string& data = header["ElementDataFile"];
  if (data == "LIST" || data.find('%') != std::string::npos)
  {
    throw std::runtime_error("its voxels are in several files. Save it as one file");
  }
  const bool is_local = data == "LOCAL" || data == "Local" || data == "local";
  const std::string voxels =
    is_local ? file : (std::filesystem::path(file).parent_path() / data).string();
  double there = SizeOf(voxels);
  double start = is_local ? static_cast<double>(stream.tellg())
                          : std::max(0.0, std::atof(header["HeaderSize"].c_str()));
  const std::string& compressed = header["CompressedData"];
  if (!compressed.empty() && std::strchr("Tt1", compressed[0]))
  {
    std::ifstream packed(voxels, std::ios::binary);
    packed.seekg(static_cast<std::streamoff>(start));
    there = InflatedSize(packed, bytes);
    start = 0;
  }
  if (there < start + bytes)
  {
    ThrowCutOff(there - start, bytes);
  }
}

/// The reader of NIfTI takes what is missing for zeros, too, compressed or not.
void CheckNifti(const std::string& file, const itk::MetaDataDictionary& dictionary)
{
  double bytes = std::atof(StringOf(dictionary, "bitpix").c_str()) / 8;
  const int dimensions = std::clamp(std::atoi(StringOf(dictionary, "dim[0]").c_str()), 0, 7);
  for (int axis = 1; axis <= dimensions; ++axis)
  {
    const std::string name = "dim[" + std::to_string(axis) + ']';
    bytes *= std::max(1.0, std::atof(StringOf(dictionary, name).c_str()));
  }
  const double due = bytes + std::atof(StringOf(dictionary, "vox_offset").c_str());
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> stream(gzopen(file.c_str(), "rb"), gzclose);
  constexpr unsigned most = 1 << 20;
  std::vector<char> part(most);
  double there = 0;
  int count = 1;
  while (stream && count > 0 && there <= due)
  {
    count = gzread(stream.get(), part.data(), most);
    there += std::max(count, 0);
  }
  if (there < due)
  {
    ThrowCutOff(there, due);
  }
  if (count < 0)
  {
    ThrowDamaged();
  }
}

/// ITK gives the voxels of such a file in mm, but leaves its origin in the unit of the file.
void RescaleOrigin(const itk::MetaDataDictionary& dictionary, Frame& frame)
{
  constexpr int metre = 1;
  constexpr int micrometre = 3;
  constexpr int bits_of_length = 7;
  const int unit = std::atoi(StringOf(dictionary, "xyzt_units").c_str()) & bits_of_length;
  const double scale = unit == metre ? 1e3 : unit == micrometre ? 1e-3 : 1;
  std::array<Vector, 2> stored{};
  for (int c = 0; c < Dimension; ++c)
  {
    const std::string axis(1, static_cast<char>('x' + c));
    const double sign = c < 2 ? -1 : 1;
    stored[0][c] = sign * std::atof(StringOf(dictionary, "qoffset_" + axis).c_str());
    std::istringstream row(StringOf(dictionary, "srow_" + axis));
    double value = 0;
    for (int i = 0; i <= Dimension; ++i)
    {
      row >> value;
    }
    stored[1][c] = sign * value;
  }
  const bool is_stored = std::any_of(stored.begin(), stored.end(),
    [&frame](const Vector& origin)
    {
      double largest = 0, difference = 0;
      for (int c = 0; c < Dimension; ++c)
      {
        largest = std::max(largest, std::abs(origin[c]));
        difference = std::max(difference, std::abs(origin[c] - frame.Origin[c]));
      }
      constexpr double rounding = 1e-4;
      return difference <= rounding * largest;
    });
  if (scale != 1 && is_stored)
  {
    for (double& x : frame.Origin)
    {
      x *= scale;
    }
  }
}

double Dot(const Vector& a, const Vector& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector Cross(const Vector& a, const Vector& b)
{
  return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}

Frame FrameOf(const itk::ImageIOBase& io)
{
  const int stored = static_cast<int>(std::min(io.GetNumberOfDimensions(), 3u));
  Frame frame;
  for (int axis = 0; axis < stored; ++axis)
  {
    const auto direction = io.GetDirection(axis);
    frame.Origin[axis] = io.GetOrigin(axis);
    for (int c = 0; c < stored; ++c)
    {
      frame.Axes[axis][c] = io.GetSpacing(axis) * direction[c];
    }
  }
  if (stored < Dimension)
  {
    // A single slice: as thick as its voxels are long.
    const Vector normal = Cross(frame.Axes[0], frame.Axes[1]);
    const double length = std::sqrt(Dot(normal, normal));
    for (int c = 0; c < Dimension; ++c)
    {
      frame.Axes[2][c] = normal[c] / std::sqrt(length);
    }
  }
  return frame;
}

/// Some versions of ITK straighten a matrix that shears, without a word.
std::optional<Frame> SformOf(const itk::MetaDataDictionary& dictionary)
{
  const auto code = [&dictionary](const char* name)
  { return std::atoi(StringOf(dictionary, name).c_str()); };
  if (code("sform_code") <= 0 || code("qform_code") > 0)
  {
    return std::nullopt;
  }
  Frame frame;
  for (int c = 0; c < Dimension; ++c)
  {
    std::istringstream row(StringOf(dictionary, "srow_" + std::string(1, "xyz"[c])));
    row >> frame.Axes[0][c] >> frame.Axes[1][c] >> frame.Axes[2][c];
  }
  return frame;
}

void CheckFrame(const Frame& frame)
{
  for (const auto& vector : { frame.Axes[0], frame.Axes[1], frame.Axes[2], frame.Origin })
  {
    if (!std::isfinite(Dot(vector, vector)))
    {
      throw std::runtime_error("its header places voxels at numbers that are not finite");
    }
  }
  for (const auto& axis : frame.Axes)
  {
    if (!(Dot(axis, axis) > 0))
    {
      throw std::runtime_error("its header has voxels without an extent: a spacing or a direction "
                               "is 0");
    }
  }
  // Headers have four digits and more; over a thousand voxels this is one.
  constexpr double tolerance = 1e-3;
  for (int a = 0; a < Dimension; ++a)
  {
    const Vector& u = frame.Axes[a];
    const Vector& v = frame.Axes[(a + 1) % Dimension];
    if (std::abs(Dot(u, v)) > tolerance * std::sqrt(Dot(u, u) * Dot(v, v)))
    {
      throw std::runtime_error("the axes of its voxels are not at right angles (a tilted gantry, a "
                               "shear). Resample it to axes at right angles in the program that "
                               "made it, and save it again");
    }
  }
}

class Image
{
public:
  explicit Image(const std::string& file)
    : IO(ReaderOf(file))
  {
    IO->SetFileName(file);
    IO->ReadImageInformation();
    const unsigned dimensions = IO->GetNumberOfDimensions();
    double values = IO->GetNumberOfComponents();
    for (unsigned axis = 0; axis < dimensions; ++axis)
    {
      values *= static_cast<double>(IO->GetDimensions(axis));
      if (axis >= Dimension && IO->GetDimensions(axis) != 1)
      {
        throw std::runtime_error("it has " + std::to_string(dimensions) +
          " dimensions, of which the last has " + std::to_string(IO->GetDimensions(axis)) +
          " volumes. Save the one that is to be read in a file of its own");
      }
    }
    if (dimensions < 2 || !(values >= 1))
    {
      throw std::runtime_error("it has no voxels");
    }
    if (values > MostValues)
    {
      std::ostringstream text;
      text << "its header tells of " << values << " values, more than the " << MostValues
           << " that are taken. Cut the organ out, in the program that made it; or the file is "
              "damaged";
      throw std::runtime_error(text.str());
    }
    Place = FrameOf(*IO);
    const auto& dictionary = IO->GetMetaDataDictionary();
    if (dynamic_cast<itk::NrrdImageIO*>(IO.GetPointer()))
    {
      Nrrd.emplace(file);
      if (Nrrd->Space == nrrdSpace3DLeftHanded || Nrrd->Space == nrrdSpace3DLeftHandedTime)
      {
        throw std::runtime_error("its space is left-handed: what it shows would be mirrored. Save "
                                 "it in one of the spaces LPS, RAS and LAS");
      }
      Place = Nrrd->Place.value_or(Place);
      Oriented = Nrrd->Place && ToLps(Nrrd->Space);
      Unit = Nrrd->Unit;
    }
    else if (dynamic_cast<itk::NiftiImageIO*>(IO.GetPointer()))
    {
      if (const auto sform = SformOf(dictionary))
      {
        CheckFrame(*sform);
      }
      RescaleOrigin(dictionary, Place);
      Oriented = std::atoi(StringOf(dictionary, "qform_code").c_str()) > 0 ||
        std::atoi(StringOf(dictionary, "sform_code").c_str()) > 0;
    }
    CheckFrame(Place);
  }

  std::string Header() const
  {
    std::ostringstream text;
    text.precision(17);
    text << "size";
    for (unsigned axis = 0; axis < Dimension; ++axis)
    {
      text << ' ' << (axis < IO->GetNumberOfDimensions() ? IO->GetDimensions(axis) : 1);
    }
    const auto write = [&text](const char* name, const Vector& x) {
      text << '\n' << name << ' ' << x[0] << ' ' << x[1] << ' ' << x[2];
    };
    write("origin", Place.Origin);
    for (const auto& axis : Place.Axes)
    {
      write("axis", axis);
    }
    text << "\ncomponents " << IO->GetNumberOfComponents() << "\noriented " << Oriented << '\n';
    if (!Unit.empty())
    {
      text << "unit " << OnOneLine(Unit) << '\n';
    }
    const auto& dictionary = IO->GetMetaDataDictionary();
    for (const auto& key : dictionary.GetKeys())
    {
      if (key.rfind("Segment", 0) == 0 && key.find(' ') == std::string::npos)
      {
        text << "key " << OnOneLine(key) << ' ' << OnOneLine(StringOf(dictionary, key)) << '\n';
      }
    }
    return text.str();
  }

  /// Writes the voxels. @returns whether they are whole numbers.
  bool WriteVoxels(int file)
  {
    itk::ImageIORegion region(IO->GetNumberOfDimensions());
    for (unsigned axis = 0; axis < IO->GetNumberOfDimensions(); ++axis)
    {
      region.SetSize(axis, IO->GetDimensions(axis));
    }
    IO->SetIORegion(region);
    const auto bytes = static_cast<std::size_t>(IO->GetImageSizeInBytes());
    this->CheckLength(static_cast<double>(bytes));
    const std::unique_ptr<char[]> buffer(new char[bytes]);
    IO->Read(buffer.get());
    const auto count = static_cast<std::size_t>(IO->GetImageSizeInComponents());
    switch (IO->GetComponentType())
    {
      case itk::IOComponentEnum::UCHAR:
        return Convert<unsigned char>(buffer.get(), count, file);
      case itk::IOComponentEnum::CHAR:
        return Convert<signed char>(buffer.get(), count, file);
      case itk::IOComponentEnum::USHORT:
        return Convert<unsigned short>(buffer.get(), count, file);
      case itk::IOComponentEnum::SHORT:
        return Convert<short>(buffer.get(), count, file);
      case itk::IOComponentEnum::UINT:
        return Convert<unsigned int>(buffer.get(), count, file);
      case itk::IOComponentEnum::INT:
        return Convert<int>(buffer.get(), count, file);
      case itk::IOComponentEnum::ULONG:
        return Convert<unsigned long>(buffer.get(), count, file);
      case itk::IOComponentEnum::LONG:
        return Convert<long>(buffer.get(), count, file);
      case itk::IOComponentEnum::ULONGLONG:
        return Convert<unsigned long long>(buffer.get(), count, file);
      case itk::IOComponentEnum::LONGLONG:
        return Convert<long long>(buffer.get(), count, file);
      case itk::IOComponentEnum::FLOAT:
        return Convert<float>(buffer.get(), count, file);
      case itk::IOComponentEnum::DOUBLE:
        return Convert<double>(buffer.get(), count, file);
      default:
        throw std::runtime_error("its voxels are no numbers");
    }
  }

  static void Write(int file, const char* bytes, std::size_t size)
  {
    while (size > 0)
    {
      const ssize_t count = write(file, bytes, size);
      if (count <= 0)
      {
        throw std::runtime_error(
          std::string("what it holds cannot be handed on: ") + std::strerror(errno));
      }
      bytes += count;
      size -= static_cast<std::size_t>(count);
    }
  }

private:
  void CheckLength(double bytes) const
  {
    const std::string file = IO->GetFileName();
    if (Nrrd)
    {
      CheckNrrd(file, *Nrrd, bytes);
    }
    else if (dynamic_cast<const itk::MetaImageIO*>(IO.GetPointer()))
    {
      CheckMetaImage(file, bytes);
    }
    else
    {
      CheckNifti(file, IO->GetMetaDataDictionary());
    }
  }

  static std::string OnOneLine(std::string text)
  {
    std::replace_if(
      text.begin(), text.end(), [](unsigned char letter) { return letter < ' '; }, ' ');
    return text;
  }

  template <class From>
  static bool Convert(const char* buffer, std::size_t count, int file)
  {
    const auto* values = reinterpret_cast<const From*>(buffer);
    const bool whole = std::all_of(values, values + count,
      [](From stored)
      {
        const auto value = static_cast<double>(stored);
        return value > std::numeric_limits<std::int32_t>::min() - 0.5 &&
          value < std::numeric_limits<std::int32_t>::max() + 0.5 &&
          std::abs(value - std::round(value)) <= LabelTolerance;
      });
    if (whole)
    {
      WriteAs<std::int32_t>(values, count, file);
    }
    else
    {
      WriteAs<double>(values, count, file);
    }
    return whole;
  }

  template <class To, class From>
  static void WriteAs(const From* values, std::size_t count, int file)
  {
    constexpr std::size_t most = 1 << 16;
    std::vector<To> part;
    for (std::size_t start = 0; start < count; start += most)
    {
      part.resize(std::min(most, count - start));
      std::transform(values + start, values + start + part.size(), part.begin(),
        [](From value)
        {
          if constexpr (std::is_integral_v<To>)
          {
            return static_cast<To>(std::lround(static_cast<double>(value)));
          }
          return static_cast<To>(value);
        });
      Write(file, reinterpret_cast<const char*>(part.data()), part.size() * sizeof(To));
    }
  }

  itk::ImageIOBase::Pointer IO;
  std::optional<NrrdHeader> Nrrd; ///< of such a file
  Frame Place;
  bool Oriented = true;
  std::string Unit;
};

/// A pipe would never end.
void CheckFile(const std::string& file)
{
  struct stat status;
  if (stat(file.c_str(), &status) != 0)
  {
    throw std::runtime_error(std::strerror(errno));
  }
  if (!S_ISREG(status.st_mode))
  {
    throw std::runtime_error("it is no file but a folder, a pipe or a device");
  }
}

std::string Read(const std::string& file, bool voxels)
{
  try
  {
    CheckFile(file);
    Image image(file);
    std::string header = image.Header();
    if (voxels)
    {
      const bool whole = image.WriteVoxels(VoxelDescriptor);
      header += std::string("whole ") + (whole ? "1" : "0") + '\n';
    }
    return header;
  }
  catch (const itk::ExceptionObject& error)
  {
    throw std::runtime_error(TextOf(error));
  }
  catch (const std::bad_alloc&)
  {
    throw std::runtime_error("there is not enough memory for it, or its header is damaged");
  }
}
}

int main(int argc, char** argv)
{
  LimitProcess();
  // ITK's parts print to standard output, which is the header's here.
  const int output = dup(STDOUT_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  const bool voxels = argc == 3 && std::strcmp(argv[1], "--voxels") == 0;
  if (argc != 2 && !voxels)
  {
    std::fputs("palpate-image: wants [--voxels] FILE\n", stderr);
    return BadArguments;
  }
  int code = 0;
  std::string text;
  try
  {
    text = Read(argv[argc - 1], voxels);
  }
  catch (const std::exception& error)
  {
    text = error.what();
    code = BadData;
  }
  try
  {
    Image::Write(output, text.data(), text.size());
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "palpate-image: %s\n", error.what());
    code = BadData;
  }
  return code;
}
