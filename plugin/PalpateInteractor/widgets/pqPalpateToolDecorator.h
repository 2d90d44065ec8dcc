// SPDX-License-Identifier: BSD-3-Clause
/// Shows a property of a filter of state spaces only where it has a meaning for the tool of its
/// input: with the attribute tool="rigid" for a rigid tool, with tool="node" for active nodes.
#pragma once

#include "pqPropertyWidgetDecorator.h"

class pqOutputPort;

class pqPalpateToolDecorator : public pqPropertyWidgetDecorator
{
  Q_OBJECT
  typedef pqPropertyWidgetDecorator Superclass;

public:
  pqPalpateToolDecorator(vtkPVXMLElement* config, pqPropertyWidget* parent);

  bool canShowWidget(bool showAdvanced) const override;

private:
  pqOutputPort* input() const;

  bool IsForRigidTool;
};
