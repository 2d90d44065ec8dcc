// SPDX-License-Identifier: BSD-3-Clause
/// What the panels of the dock are made of.
#pragma once

#include <QComboBox>
#include <QFormLayout>
#include <QLabel>

constexpr const char* pqPalpateFaultStyle = "color: #a00000";

template <class T>
T* pqPalpateNamed(T* widget, const char* name, const char* tip = "")
{
  widget->setObjectName(name);
  widget->setToolTip(tip);
  return widget;
}

/// Keeps a list from growing with its names, which may be long.
inline void pqPalpateKeepNarrow(QComboBox* choice)
{
  constexpr int letters = 7;
  choice->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  choice->setMinimumContentsLength(letters);
}
