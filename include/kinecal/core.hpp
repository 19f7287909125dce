// Door of kinecal::core: from geometry to crate, all that needs Eigen alone.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate.hpp"
#include "kinecal/errors.hpp"
#include "kinecal/geometry.hpp"
#include "kinecal/kinematics.hpp"
#include "kinecal/parameters.hpp"
#include "kinecal/samples.hpp"
#include "kinecal/sensors.hpp"
