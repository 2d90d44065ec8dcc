// SPDX-License-Identifier: BSD-3-Clause
// Writes FEBio's file: XML, and numbers as text.
#pragma once

#include <array>
#include <charconv>
#include <initializer_list>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace vtkPalpateFEBio
{
/// A number with as many digits as it takes to read the same number back.
template <class Number>
void Append(Number number, std::string& text)
{
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
  text.append(digits.data(), end);
}

template <class Number>
std::string Text(Number number)
{
  std::string text;
  Append(number, text);
  return text;
}

/// Numbers with commas between them.
template <class Numbers>
std::string List(const Numbers& numbers)
{
  std::string text;
  for (const auto number : numbers)
  {
    if (!text.empty())
    {
      text += ',';
    }
    Append(number, text);
  }
  return text;
}

/// Writes XML element by element, escaped by VTK, since a tree of the whole file
/// (vtkXMLDataElement) takes 2.5 KB for each node of a mesh. FEBio takes white space around a word
/// for a part of it, so that the content of an element is on the line of its tags.
class Output
{
public:
  using Attributes = std::initializer_list<std::pair<const char*, std::string>>;

  explicit Output(std::ostream& stream);

  void Open(const char* name, Attributes attributes = {});

  void Close();

  void Leaf(const char* name, Attributes attributes, const std::string& text);

  void Empty(const char* name, Attributes attributes);

private:
  void Indent();

  void Start(const char* name, Attributes attributes);

  void Escape(const std::string& text);

  std::ostream& Stream;
  std::vector<const char*> Levels;
};
}
