// SPDX-License-Identifier: BSD-3-Clause
/// Shows a property of a filter of state spaces where it has a meaning for the tool of its input:
/// with the attribute tool="rigid" of a rigid one, with tool="node" of active nodes.
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
