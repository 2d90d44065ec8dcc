// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkSMPalpateRenamedProperty
 * @brief the old name of a list of integers that has another name now
 *
 * What is set by the old name, in a state or a script of an earlier version, is set by the new one:
 *
 *   <PalpateRenamedProperty name="ActiveNode" new_name="ActiveNodes"
 * si_class="vtkSIIntVectorProperty" repeatable="1" panel_visibility="never" />
 *
 * It has no command of its own and is not shown. A state that is saved has both; there the one that
 * comes later in the alphabet counts, so the new name has to be the later one.
 */
#pragma once

#include <string>

#include "vtkSMIntVectorProperty.h"

class vtkSMPalpateRenamedProperty : public vtkSMIntVectorProperty
{
public:
  static vtkSMPalpateRenamedProperty* New();
  vtkTypeMacro(vtkSMPalpateRenamedProperty, vtkSMIntVectorProperty);

  /// Sets what has the new name, unless this is empty.
  void Modified() override;

protected:
  int ReadXMLAttributes(vtkSMProxy* parent, vtkPVXMLElement* element) override;

private:
  std::string NewName;
};

/// Makes the class known to ParaView. Called when the plugin is loaded.
void PalpateAddRenamedProperty();
