// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFEBioOutput.h"

#include "vtkXMLUtilities.h"

namespace vtkPalpateFEBio
{
Output::Output(std::ostream& stream)
  : Stream(stream)
{
  this->Stream << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
}

void Output::Open(const char* name, Attributes attributes)
{
  this->Start(name, attributes);
  this->Stream << ">\n";
  this->Levels.push_back(name);
}

void Output::Close()
{
  const char* name = this->Levels.back();
  this->Levels.pop_back();
  this->Indent();
  this->Stream << "</" << name << ">\n";
}

void Output::Leaf(const char* name, Attributes attributes, const std::string& text)
{
  this->Start(name, attributes);
  this->Stream << '>';
  this->Escape(text);
  this->Stream << "</" << name << ">\n";
}

void Output::Empty(const char* name, Attributes attributes)
{
  this->Start(name, attributes);
  this->Stream << "/>\n";
}

void Output::Indent()
{
  for (std::size_t i = 0; i < this->Levels.size(); ++i)
  {
    this->Stream << '\t';
  }
}

void Output::Start(const char* name, Attributes attributes)
{
  this->Indent();
  this->Stream << '<' << name;
  for (const auto& [key, value] : attributes)
  {
    this->Stream << ' ' << key << "=\"";
    this->Escape(value);
    this->Stream << '"';
  }
}

void Output::Escape(const std::string& text)
{
  vtkXMLUtilities::EncodeString(
    text.c_str(), VTK_ENCODING_UTF_8, this->Stream, VTK_ENCODING_UTF_8, 1);
}
}
