// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "kernels/matcher.h"
#include "trust/dull_cells.h"
#include "trust/eye_texture.h"
#include "trust/row_offsets.h"
#include "trust/trust_options.h"

namespace disparityd::trust {

/// What is said of a frame.
struct Verdict {
    std::uint32_t doubts = 0;  ///< bits of proto::Doubt
    std::uint8_t trust = 0;    ///< 1 .. 255, more is better; 0: the image is too small to be judged
};

/// Judges frames, step 15 of docs/algorithm.md. What shows in a single picture counts at once; a blurred or a dirty eye
/// and rows that do not fit are decided over windows of a second. All memory is its own. One thread.
class Judge {
public:
    /// The rectified size. `masked` is not 0 where the left image shows the robot itself; empty where it does nowhere.
    /// It is read by the constructor only.
    Judge(int width, int height, const TrustOptions& options, Plane<const std::uint8_t> masked = {});

    /// `time_ns` is that of the frame's capture, on any clock. `anew`: earlier frames have nothing to do with it.
    /// `near_blocks`: how many blocks of frame.near show no ground, where that is known.
    Verdict judge(const FrameView& frame, std::int64_t time_ns, bool anew,
                  std::optional<std::ptrdiff_t> near_blocks = std::nullopt);

    /// Returns the cells of the left image that an eye sees through dirt; none as long as no eye is dirty.
    const Cells<bool>& dirty_cells() const { return findings_.dirty_cells; }

private:
    enum EyeIndex : unsigned char { left, right };

    /// Sums over the frames of a window.
    struct Window {
        std::int64_t began_ns = 0;
        int frames = 0;
        std::array<Cells<std::int64_t>, 2> fine{};
        std::array<Cells<int>, 2> judged{};  ///< frames in which the state of a cell was known
        std::array<Cells<int>, 2> dull{};
        RowOffsets rows;
    };

    /// Something that must be found some times in a row before it holds, and missed some times before it is over.
    class Held {
    public:
        Held(int until_held, int until_over) : until_held_(until_held), until_over_(until_over) {}
        void note(bool found);
        bool holds() const { return holds_; }

    private:
        int until_held_;
        int until_over_;
        int found_ = 0;
        int missed_ = 0;
        bool holds_ = false;
    };

    /// What is known of the eyes, from the frames since the source began.
    struct Findings {
        Held covered{5, 15};  // frames; the others: windows
        Held blurred{2, 3};
        Held dirty{1, 3};  // each of its cells for three windows
        Held misaligned{2, 3};
        std::array<Cells<int>, 2> dull_windows{};  ///< windows in a row in which a cell was dull
        Cells<bool> dirty_cells{};                 ///< of the left image
        Cells<bool> mapped_cells{};                ///< those of them that show dirt of the right eye
    };

    void set_masked_cells(Plane<const std::uint8_t> masked);
    void add_to_window(const FrameView& frame);
    void close_window(const FrameView& frame);
    bool find_blurred() const;
    bool find_dirty();
    bool find_misaligned() const;
    void find_dirty_cells(const FrameView& frame);
    std::uint32_t doubts(const FrameView& frame, std::optional<std::ptrdiff_t> near_blocks) const;

    TrustOptions options_;
    int rows_limit_;                       ///< 1/16 px
    bool judged_;                          ///< images of this size are
    std::array<Cells<bool>, 2> masked_{};  ///< cells that may show the robot itself
    std::array<EyeMeter, 2> meters_;
    std::array<EyeTexture, 2> eyes_{};
    DullCells cells_;
    Window window_;
    Findings findings_;
    std::array<Cells<bool>, 2> dirt_{};  ///< of the window that was closed last
    std::uint32_t turn_ = 0;
};

}  // namespace disparityd::trust
