// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "capture/images/image_sequence.h"

namespace disparityd::capture {

/// Returns the two folders within `folder` that hold the images of an eye each, by their names (left and right, cam0
/// and cam1 as EuRoC has them); nothing where there are none.
std::optional<std::pair<std::string, std::string>> find_folders_of_eyes(const std::string& folder);

/// Splits the names of two folders at a comma. Names may have commas, too: only folders that are there are taken.
std::optional<std::pair<std::string, std::string>> pair_of_folders(const std::string& uri);

/// Pairs the images of two folders: those of the same name, else those whose names have the same last number. In the
/// order of their numbers. Throws std::invalid_argument with one line where a left image has no right one, or several.
ImageSequence pair_images(const std::string& left, const std::string& right);

/// Returns a line for people on images of the right folder that are in none of so many pairs; empty where all are.
std::string unpaired_images(const std::string& right, std::size_t pairs);

/// Returns the time that a name without its ending is, in ns: 19, 16 or 13 digits are ns, us or ms, a number with a
/// point is seconds. Nothing for other names.
std::optional<std::int64_t> time_of_name(std::string_view stem);

/// Takes the times of the frames from the names of their left images, where each is one, alone or beside other words as
/// in left_1403636579763555584.png, and they rise.
void take_times_of_names(ImageSequence& sequence);

}  // namespace disparityd::capture
