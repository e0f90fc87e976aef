// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/steps.h"

/// docs/algorithm.md as plain scalar code: the definition that every other back end is compared with.
/// The functions are documented in kernels/steps.h.
namespace disparityd::reference {

void rectify(const RawImage& raw, Eye eye, const Rectifier& rectifier, Plane<std::uint8_t> out, Rows rows);
void rectify_colour(const RawImage& raw, Eye eye, const Rectifier& rectifier, Plane<std::uint8_t> bgr, Rows rows);
void sad(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, DisparityRange range,
         Volume<std::uint16_t> costs, Rows rows);
void census(Plane<const std::uint8_t> image, Plane<std::uint64_t> words, Rows rows);
void matching_cost(Plane<const std::uint64_t> left, Plane<const std::uint64_t> right, DisparityRange range,
                   Volume<std::uint8_t> costs, Rows rows);

/// The words of census-7x5+gradient, and its costs.
void census_gradient(Plane<const std::uint8_t> image, Plane<std::uint64_t> words, Rows rows);
void census_gradient_cost(Plane<const std::uint64_t> left, Plane<const std::uint64_t> right, DisparityRange range,
                          Volume<std::uint8_t> costs, Rows rows);

/// The same words at noise levels, and the image that they are made from.
void smooth(Plane<const std::uint8_t> image, Plane<std::uint8_t> smoothed, Rows rows);
void noisy_census(Plane<const std::uint8_t> image, Plane<const std::uint8_t> smoothed, int coarseness,
                  Plane<std::uint64_t> words, Rows rows);

void aggregate(Volume<const std::uint8_t> costs, Plane<const std::uint8_t> left, const SgmOptions& options,
               Volume<std::uint16_t> sums, std::span<std::byte> scratch, Parallel& workers);
std::size_t aggregate_scratch(int width, int height, int disparities);

template <typename T>
void winner_left(Volume<const T> costs, DisparityRange range, bool subpixel, Plane<std::int16_t> winner,
                 Plane<std::int16_t> disparity, Rows rows);
template <typename T>
void winner_right(Volume<const T> costs, DisparityRange range, Plane<std::int16_t> winner, Rows rows);
template <typename T>
void local_extrema(Volume<const T> costs, DisparityRange range, const PostOptions& options,
                   Plane<const std::int16_t> winner, Plane<std::int16_t> disparity, Plane<std::uint8_t> confidence,
                   Rows rows);

void left_right(Plane<const std::int16_t> left_winner, Plane<const std::int16_t> right_winner, DisparityRange range,
                Plane<std::int16_t> disparity, Rows rows);
void median(Plane<const std::int16_t> in, std::int16_t invalid, int size, Plane<std::int16_t> out, Rows rows);
void vote(Plane<const std::int16_t> in, std::int16_t invalid, Plane<std::int16_t> out, Rows rows);
void speckle(Plane<std::int16_t> disparity, const RegionTest& test, std::span<std::byte> scratch);
std::size_t speckle_scratch(int width, int height);
void finish_confidence(Plane<const std::int16_t> disparity, std::int16_t invalid, bool calibrated,
                       Plane<std::uint8_t> confidence, Rows rows);
void interpolate(Plane<std::int16_t> disparity, Plane<const std::int16_t> right_winner, DisparityRange range,
                 std::span<std::byte> scratch);
std::size_t interpolate_scratch(int width, int height);
void guided_median(Plane<const std::int16_t> in, Plane<const std::uint8_t> guide, std::int16_t invalid, int size,
                   Plane<std::int16_t> out, Rows rows);
void depth(Plane<const std::int16_t> disparity, std::int16_t invalid, DepthScale scale, Plane<std::uint16_t> depth,
           Rows rows);
void depth_error(Plane<const std::int16_t> disparity, Plane<const std::uint8_t> confidence,
                 const DepthErrorScale& scale, Plane<std::uint16_t> error, Rows rows);
void shrink(Plane<const std::uint8_t> image, Plane<std::uint8_t> out, Rows rows);
void scan_counts(const scan::Pixels& pixels, const scan::CountTables& tables, scan::Counts& counts);

/// All of the above as a table.
extern const KernelSteps steps;

}  // namespace disparityd::reference
