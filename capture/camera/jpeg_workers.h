// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "base/waker.h"
#include "capture/camera/video_stream.h"
#include "capture/eye_layout.h"
#include "capture/jpeg_decoder.h"
#include "capture/loan_pool.h"

namespace disparityd::capture {

/// Decodes a camera's JPEGs in threads of its own and hands the frames out in the order of capture. One thread calls
/// everything; give_back() may come from any.
class JpegWorkers {
public:
    /// A JPEG that was decoded, or could not be.
    struct Decoded {
        VideoFrame frame;  ///< data and loan are of the decoded pixels (JpegDecoder), the rest is of the JPEG
        std::span<const std::uint8_t> jpeg;  ///< valid as long as the loan
        std::string problem;                 ///< empty: the frame is whole and a loan
    };

    /// `threads` 0: submit() decodes. `loans` are the frames that may be out at a time. A JPEG goes back to `stream`
    /// with its frame. `waker` is woken when a frame is decoded or comes back. Both are borrowed. Throws as
    /// base::start_thread().
    JpegWorkers(const EyeLayout& layout, int threads, int loans, VideoStream& stream, base::Waker& waker);
    ~JpegWorkers();
    JpegWorkers(const JpegWorkers&) = delete;
    JpegWorkers& operator=(const JpegWorkers&) = delete;

    /// How many JPEGs are held at most: so many loans the stream must allow.
    int most_jpegs() const { return static_cast<int>(frames_.size()); }

    /// Whether there is memory for one more frame.
    bool has_room();

    /// Whether frames are being decoded, or wait for take().
    bool busy();

    /// Takes over the loan of a JPEG. There must be room.
    void submit(const VideoFrame& jpeg);

    /// Returns the next one if it is ready and not all loans are out.
    std::optional<Decoded> take();

    /// Waits for what is being decoded, and forgets all that take() has not returned.
    void forget();

    void give_back(int loan) noexcept;

private:
    struct Job {
        VideoFrame jpeg;
        int slot = -1;
        bool done = false;
        std::string problem;
    };

    void drop(const Job& job);
    Job& job(std::uint64_t number) { return jobs_[number % jobs_.size()]; }
    void end();
    void work(JpegDecoder& decoder);
    void decode(JpegDecoder& decoder, Job& job);

    const int loans_;
    VideoStream& stream_;
    base::Waker& waker_;
    std::vector<std::vector<std::uint8_t>> frames_;
    std::vector<int> jpeg_loans_;                         ///< of the frame with the same number
    std::vector<std::unique_ptr<JpegDecoder>> decoders_;  ///< one for each thread

    std::mutex mutex_;  ///< what follows
    std::condition_variable changed_;
    LoanPool free_;
    std::vector<Job> jobs_;        ///< a ring: as many as there are frames
    std::uint64_t submitted_ = 0;  ///< jobs so far, by the step that they have reached
    std::uint64_t begun_ = 0;
    std::uint64_t taken_ = 0;
    int lent_ = 0;
    bool ending_ = false;

    std::vector<std::thread> threads_;
};

}  // namespace disparityd::capture
