// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateXMLTree.h"

#include <algorithm>
#include <fstream>

#include "base/error.h"
#include "base/printable.h"
#include "base/read_file.h"
#include "vtkCommand.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkXMLParser.h"

namespace
{
using palpate::InputError;

/// The largest depth of a tree. No format that we read is deeper, and the destructor of a tree is
/// recursive.
constexpr int MostLevels = 100;

void Trim(std::string& text)
{
  constexpr const char* space = " \t\r\n";
  text.erase(text.find_last_not_of(space) + 1);
  text.erase(0, text.find_first_not_of(space));
}

class Parser : public vtkXMLParser
{
public:
  static Parser* New();
  vtkTypeMacro(Parser, vtkXMLParser);

  /// VTK's message about the fault; empty if there is none.
  std::string Fault;
  vtkPalpateXMLTree Root;
  bool TooDeep = false;

protected:
  Parser() { this->AddObserver(vtkCommand::ErrorEvent, this, &Parser::TakeError); }
  ~Parser() override = default;

  void StartElement(const char* name, const char** attributes) override
  {
    if (++this->Level > MostLevels)
    {
      this->TooDeep = true;
      return;
    }
    vtkPalpateXMLTree& element = this->Open.emplace_back();
    element.Name = name;
    for (int i = 0; attributes[i]; i += 2)
    {
      element.Attributes.emplace_back(attributes[i], attributes[i + 1]);
    }
  }

  void EndElement(const char*) override
  {
    if (this->Level-- > MostLevels)
    {
      return;
    }
    vtkPalpateXMLTree element = std::move(this->Open.back());
    this->Open.pop_back();
    Trim(element.Text);
    (this->Open.empty() ? this->Root : this->Open.back().Children.emplace_back()) =
      std::move(element);
  }

  void CharacterDataHandler(const char* data, int length) override
  {
    if (!this->Open.empty())
    {
      this->Open.back().Text.append(data, length);
    }
  }

  /// The rest of the file is not kept.
  int ParsingComplete() override { return this->TooDeep || this->Superclass::ParsingComplete(); }

private:
  void TakeError(vtkObject*, unsigned long, void* message)
  {
    std::string text = static_cast<const char*>(message);
    // The rest of the message says where in VTK's source the error was found.
    const std::size_t begin = text.find("Error parsing");
    text.erase(0, begin == std::string::npos ? 0 : begin);
    Trim(text);
    this->Fault = text;
  }

  int Level = 0;
  /// The open elements, from the root to the one that is being read.
  std::vector<vtkPalpateXMLTree> Open;
};

vtkStandardNewMacro(Parser);
}

const std::string* vtkPalpateXMLTree::Attribute(const char* name) const
{
  const auto found = std::find_if(this->Attributes.begin(), this->Attributes.end(),
    [name](const auto& attribute) { return attribute.first == name; });
  return found == this->Attributes.end() ? nullptr : &found->second;
}

const vtkPalpateXMLTree* vtkPalpateXMLTree::Child(const char* name) const
{
  const auto found = std::find_if(this->Children.begin(), this->Children.end(),
    [name](const vtkPalpateXMLTree& child) { return child.Name == name; });
  return found == this->Children.end() ? nullptr : &*found;
}

vtkPalpateXMLTree vtkPalpateReadXML(const std::string& fileName)
{
  std::ifstream file = palpate::open_to_read(fileName);
  vtkNew<Parser> parser;
  parser->SetStream(&file);
  const bool isWhole = parser->Parse() != 0;
  if (parser->TooDeep)
  {
    throw InputError("The file " + palpate::quoted(fileName) + " has more than " +
      std::to_string(MostLevels) +
      " levels of elements within each other, as no file of this format has.");
  }
  if (!isWhole || !parser->Fault.empty())
  {
    throw InputError("The file " + palpate::quoted(fileName) + " is no XML, or it is not whole. " +
      palpate::printable(parser->Fault) + ". Take a copy that is whole.");
  }
  return std::move(parser->Root);
}
