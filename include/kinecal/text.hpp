// Umbrella header of text/: names, numbers and texts for people, and text that the compiler knows.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/text/characters.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/first_names.hpp"
#include "kinecal/text/fixed_string.hpp"
#include "kinecal/text/frame_name.hpp"
#include "kinecal/text/image_region.hpp"
#include "kinecal/text/name_list.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/text/printable.hpp"
#include "kinecal/text/reading.hpp"
#include "kinecal/text/sentence.hpp"
#include "kinecal/text/shell_command.hpp"
#include "kinecal/text/wrapped.hpp"
