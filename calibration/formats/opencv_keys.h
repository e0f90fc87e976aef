// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "calibration/formats/opencv_storage.h"

/// The names that people give to the entries of an OpenCV file, as plain_name() spells them.
namespace disparityd::calibration {

struct EyeKeys {
    std::span<const std::string_view> matrix;
    std::span<const std::string_view> distortion;
};

extern const EyeKeys left_eye_keys;  ///< M1, K_LEFT, cameraMatrix1 ...; D1, D_LEFT, distCoeffs1 ...
extern const EyeKeys right_eye_keys;
extern const std::span<const std::string_view> rotation_keys;       ///< R, rotation ...
extern const std::span<const std::string_view> translation_keys;    ///< T, translation ...
extern const std::span<const std::string_view> single_camera_keys;  ///< camera_matrix, K, mtx: of one camera alone
extern const std::span<const std::string_view> unit_keys;
extern const std::span<const std::string_view> model_keys;  ///< the lens model by its name

/// Returns whether this is one of the names; `name` as the file spells it.
bool is_among(std::string_view name, std::span<const std::string_view> names);

/// Returns whether the entry says nothing that rectification depends on, such as how the calibration came about.
/// rectification_result() knows those that must agree with the rest.
bool is_harmless_key(std::string_view name);

/// Returns whether the entry says how every pixel moves (H1, map11, stereoMapL_x ...), which follows from the cameras.
bool is_map_key(std::string_view name);

/// Compares the sizes under all usual keys (image_width, imageSize, Size, resolution ...) with that of the frames, and
/// returns whether there was one. Throws std::invalid_argument with one line for another size.
bool check_sizes(const OpencvStorage& file, const std::string& path, int width, int height);

/// Returns whether the entry is a size that check_sizes() looks at.
bool is_size_key(std::string_view name);

}  // namespace disparityd::calibration
