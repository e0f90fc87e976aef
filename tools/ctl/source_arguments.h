// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "capture/frame_source.h"

namespace disparityd::tools {

/// Whether a source is a file or a folder, whose frames wait for whoever takes them.
bool is_kept(const std::string& uri);

/// Whether such a source may take its calibration from a folder of calibrations, beside its own files.
bool is_calibrated_elsewhere(const std::string& uri);

/// Opens a source with a progress bar while it prepares itself. What one that is kept says of itself is printed, unless
/// `options.report` is set. Throws as capture::open_source does, and std::invalid_argument where the stamps contain
/// another offset than `options` ask for.
std::unique_ptr<capture::FrameSource> open_with_progress(capture::SourceOptions options);

/// Adds the option --time-offset-us, with more words at the begin of its help.
void add_time_offset(CLI::App& command, std::optional<int>& offset_us, const std::string& when = "");

/// Returns the next frame, which the source lends; nothing at its end or after Ctrl-C (see catch_interrupts()).
std::optional<capture::RawFrame> next_frame(capture::FrameSource& source);

/// Returns "1280 x 720 per eye, yuyv, 15 frames/s, 90 frames" and whether a calibration is known.
std::string summary(const capture::SourceInfo& source);

}  // namespace disparityd::tools
