// Door of samples/: what was recorded.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/samples/sample.hpp"
