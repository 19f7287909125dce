// Umbrella header of trust/: how far a result can be believed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/trust/observability.hpp"
