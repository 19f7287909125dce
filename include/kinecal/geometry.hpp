// Umbrella header of geometry/: jets, packets, rotations, poses, a median, and linear
// systems.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/geometry/eigen_layout.hpp"
#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/geometry/jet.hpp"
#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/geometry/least_norm.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/geometry/packet.hpp"
#include "kinecal/geometry/planar_motion.hpp"
#include "kinecal/geometry/pose.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/geometry/scalar.hpp"
#include "kinecal/geometry/sin_cos.hpp"
#include "kinecal/geometry/traced.hpp"
