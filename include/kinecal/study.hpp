// Umbrella header of study/: simulated robots.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/study/seeded_random.hpp"
