// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateImageFile.h"

#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <sstream>

#include "base/error.h"
#include "base/find_program.h"
#include "program/exit_codes.h"
#include "vtkMath.h"
#include "vtkPalpateProgram.h"

namespace
{
using palpate::BackendError;
using palpate::InputError;

/// The header that the program writes, and whether it has voxels of whole numbers.
struct Answer
{
  vtkPalpateImageHeader Header;
  bool Whole = false;
};

Answer Parse(const std::string& text)
{
  Answer answer;
  vtkPalpateImageHeader& header = answer.Header;
  std::istringstream lines(text);
  std::size_t axes = 0;
  for (std::string line; std::getline(lines, line);)
  {
    std::istringstream words(line);
    std::string word;
    words >> word;
    const auto read = [&words](auto& numbers)
    {
      for (auto& number : numbers)
      {
        words >> number;
      }
    };
    if (word == "size")
    {
      read(header.Size);
    }
    else if (word == "origin")
    {
      read(header.Origin);
    }
    else if (word == "axis" && axes < header.Axes.size())
    {
      read(header.Axes[axes++]);
    }
    else if (word == "components")
    {
      words >> header.Components;
    }
    else if (word == "oriented")
    {
      words >> header.Oriented;
    }
    else if (word == "unit")
    {
      words >> header.Unit;
    }
    else if (word == "whole")
    {
      words >> answer.Whole;
    }
    else if (word == "key")
    {
      std::string key;
      words >> key >> std::ws;
      std::getline(words, header.Keys[key]);
    }
  }
  return answer;
}

Answer Run(
  const std::string& file, const vtkPalpateNamelessFile* voxels, const std::function<void()>& poll)
{
  const std::string program =
    palpate::find_program("palpate-image", "PALPATE_IMAGE", "Build it (PALPATE_WITH_ITK)");
  vtkPalpateNamelessFile input, header, errors;
  std::vector<std::string> arguments;
  std::vector<const vtkPalpateNamelessFile*> files = { &input, &header, &errors };
  if (voxels)
  {
    arguments.emplace_back("--voxels");
    files.push_back(voxels);
  }
  arguments.push_back(file);
  // Even the largest image is read in a minute.
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(10);
  const auto status = vtkPalpateRunProgram(program, arguments, files, deadline, poll);
  const std::string refused = "The file " + file + " cannot be read: ";
  if (!status)
  {
    throw InputError(refused + "palpate-image did not come to an end.");
  }
  if (WIFSIGNALED(*status))
  {
    throw InputError(refused + "it brings ITK down (signal " + std::to_string(WTERMSIG(*status)) +
      ", " + strsignal(WTERMSIG(*status)) + "); it is damaged.");
  }
  if (WEXITSTATUS(*status) == vtkPalpateExitCode::BadData)
  {
    throw InputError(refused + header.Read() + '.');
  }
  if (WEXITSTATUS(*status) != 0)
  {
    throw BackendError("palpate-image (" + program + ") failed (exit code " +
      std::to_string(WEXITSTATUS(*status)) + "). " + vtkPalpateLastWords(errors));
  }
  return Parse(header.Read());
}

template <class Value>
void ReadVoxels(const vtkPalpateNamelessFile& file, std::size_t count, std::vector<Value>& voxels)
{
  if (file.Size() != count * sizeof(Value))
  {
    throw BackendError("palpate-image gave " + std::to_string(file.Size()) + " bytes for " +
      std::to_string(count) + " values.");
  }
  voxels.resize(count);
  file.ReadInto(voxels.data(), file.Size());
}

/// Which of the old axes are the new ones, and which of them are turned round.
struct Arrangement
{
  std::array<int, 3> Axis{};
  std::array<bool, 3> Turned{};
};

Arrangement BestArrangement(const vtkPalpateImageHeader& header)
{
  std::array<int, 3> axis = { 0, 1, 2 };
  Arrangement best;
  double most = -1;
  do
  {
    double sum = 0;
    for (int c = 0; c < 3; ++c)
    {
      const auto& along = header.Axes[axis[c]];
      sum += std::abs(along[c]) / vtkMath::Norm(along.data());
    }
    if (sum > most)
    {
      most = sum;
      best.Axis = axis;
    }
  } while (std::next_permutation(axis.begin(), axis.end()));
  for (int c = 0; c < 3; ++c)
  {
    best.Turned[c] = header.Axes[best.Axis[c]][c] < 0;
  }
  return best;
}

template <class Value>
void Arrange(const Arrangement& arrangement, const std::array<int, 3>& old,
  const std::array<int, 3>& size, std::size_t components, std::vector<Value>& voxels)
{
  if (voxels.empty())
  {
    return;
  }
  const std::array<std::ptrdiff_t, 3> stride = { 1, old[0],
    static_cast<std::ptrdiff_t>(old[0]) * old[1] };
  std::ptrdiff_t first = 0;
  std::array<std::ptrdiff_t, 3> step{};
  for (int c = 0; c < 3; ++c)
  {
    step[c] = stride[arrangement.Axis[c]];
    if (arrangement.Turned[c])
    {
      first += (size[c] - 1) * step[c];
      step[c] = -step[c];
    }
  }
  std::vector<Value> arranged(voxels.size());
  Value* to = arranged.data();
  const auto values = static_cast<std::ptrdiff_t>(components);
  for (int k = 0; k < size[2]; ++k)
  {
    for (int j = 0; j < size[1]; ++j)
    {
      const Value* from = voxels.data() + (first + j * step[1] + k * step[2]) * values;
      for (int i = 0; i < size[0]; ++i, from += step[0] * values)
      {
        to = std::copy_n(from, values, to);
      }
    }
  }
  voxels = std::move(arranged);
}
}

double vtkPalpateImageHeader::Volume() const
{
  return std::abs(vtkMath::Determinant3x3(Axes[0].data(), Axes[1].data(), Axes[2].data()));
}

bool vtkPalpateIsImageFile(const std::string& file)
{
  std::string name = file;
  std::transform(name.begin(), name.end(), name.begin(),
    [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  const std::array<std::string, 6> ends = { ".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz" };
  return std::any_of(ends.begin(), ends.end(),
    [&name](const std::string& end)
    {
      return name.size() > end.size() &&
        name.compare(name.size() - end.size(), end.size(), end) == 0;
    });
}

vtkPalpateImageHeader vtkPalpateReadImageHeader(const std::string& file)
{
  return Run(file, nullptr, {}).Header;
}

vtkPalpateImageFile vtkPalpateReadImageFile(
  const std::string& file, const std::function<void()>& poll)
{
  vtkPalpateNamelessFile voxels;
  const Answer answer = Run(file, &voxels, poll);
  vtkPalpateImageFile image;
  image.Header = answer.Header;
  const std::size_t count =
    image.Header.Count() * static_cast<std::size_t>(image.Header.Components);
  if (answer.Whole)
  {
    ReadVoxels(voxels, count, image.Labels);
  }
  else
  {
    ReadVoxels(voxels, count, image.Values);
  }
  return image;
}

void vtkPalpateArrangeImage(vtkPalpateImageFile& image)
{
  const vtkPalpateImageHeader old = image.Header;
  const Arrangement arrangement = BestArrangement(old);
  vtkPalpateImageHeader& header = image.Header;
  for (int c = 0; c < 3; ++c)
  {
    const int axis = arrangement.Axis[c];
    header.Size[c] = old.Size[axis];
    for (int x = 0; x < 3; ++x)
    {
      const double along = old.Axes[axis][x];
      header.Axes[c][x] = arrangement.Turned[c] ? -along : along;
      header.Origin[x] += arrangement.Turned[c] ? (old.Size[axis] - 1) * along : 0;
    }
  }
  const auto components = static_cast<std::size_t>(header.Components);
  Arrange(arrangement, old.Size, header.Size, components, image.Labels);
  Arrange(arrangement, old.Size, header.Size, components, image.Values);
}
