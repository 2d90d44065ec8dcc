// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkSMPalpateToolProperty
 * @brief the tool of a filter, one of a list of proxies
 *
 * In states of earlier versions it has the number of the tool instead of a proxy, and the tool's
 * properties are the filter's own: see vtkSMPalpateOldToolProperty.
 */
#pragma once

#include <vector>

#include "vtkSMProxyProperty.h"

class vtkSMPalpateToolProperty : public vtkSMProxyProperty
{
public:
  static vtkSMPalpateToolProperty* New();
  vtkTypeMacro(vtkSMPalpateToolProperty, vtkSMProxyProperty);

  /// Makes all that may be chosen where there are none yet, as while a state is loaded.
  void MakeTools();
  /// All that may be chosen.
  std::vector<vtkSMProxy*> Tools();

  /// Lets the old properties read what is chosen now.
  void Modified() override;
  int LoadState(vtkPVXMLElement* element, vtkSMProxyLocator* loader) override;
};

/// Makes the properties of tools known to ParaView. Called when the plugin is loaded.
void PalpateAddToolProperties();
