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

#include <itkMetaDataObject.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "image/check_length.h"
#include "image/frame.h"
#include "image/nrrd_header.h"
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
