// What built_in_base_blocks.hpp declares, compiled.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/built_in_base_blocks.hpp"

#ifndef KINECAL_HEADER_ONLY
namespace kinecal::detail {
KINECAL_BASE_BLOCK_CODE();
}  // namespace kinecal::detail
#endif
