// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkSMPalpateOldToolProperty
 * @brief a property of a tool by the name that it had when it was one of the filter
 *
 * What is set by the old name, in a state or a script of an earlier version, is set in all tools
 * that the filter's property Tool may choose and that have it by the new one:
 *
 *   <PalpateOldToolProperty name="ToolRadius" new_name="Radius" number_of_elements="1"
 *                           default_values="none" si_class="vtkSIDoubleVectorProperty"
 *                           panel_visibility="never" />
 *
 * It reads what the chosen tool has. The value is the tool's: it is not shown, saved or undone
 * here.
 */
#pragma once

#include <string>
#include <vector>

#include "vtkSMDoubleVectorProperty.h"
#include "vtkWeakPointer.h"

class vtkSMPalpateOldToolProperty : public vtkSMDoubleVectorProperty
{
public:
  static vtkSMPalpateOldToolProperty* New();
  vtkTypeMacro(vtkSMPalpateOldToolProperty, vtkSMDoubleVectorProperty);

  /// Reads the value of the chosen tool, or of the first that has it, now and when it changes.
  void Follow();

  /// Sets what has the new name.
  void Modified() override;
  void Copy(vtkSMProperty*) override {}
  /// Resets what has the new name.
  void ResetToXMLDefaults() override;
  void ReadFrom(const vtkSMMessage*, int, vtkSMProxyLocator*) override {}
  void SaveState(vtkPVXMLElement*, const char*, const char*, int) override {}

protected:
  vtkSMPalpateOldToolProperty() = default;
  ~vtkSMPalpateOldToolProperty() override;

  int ReadXMLAttributes(vtkSMProxy* parent, vtkPVXMLElement* element) override;

private:
  void Read();
  /// What has the new name in each of the tools.
  std::vector<vtkSMDoubleVectorProperty*> OfTools();

  std::string NewName;
  vtkWeakPointer<vtkSMProperty> Followed;
  unsigned long Observer = 0;
  bool IsReading = false;
};
