// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateMotion.h"

vtkPalpateMotion::vtkPalpateMotion() = default;

vtkPalpateMotion::~vtkPalpateMotion() = default;
