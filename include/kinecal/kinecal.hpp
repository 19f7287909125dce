// The whole of kinecal.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/geometry.hpp"
#include "kinecal/kinematics.hpp"
