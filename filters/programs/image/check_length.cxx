// SPDX-License-Identifier: BSD-3-Clause
#include "image/check_length.h"

#include <zlib.h>

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace
{
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
