// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "pipeline/worker_pool.h"
#include "tools/ctl/describe.h"
#include "tools/ctl/processing/frame_copy.h"

namespace disparityd::tools {

/// Writes the files of several frames at once, in threads of its own. Each holds a compute slot of the pool that
/// matches while it works: as many threads compute as there are workers, whatever they do. One thread uses it.
class FrameWriters {
public:
    /// Writes a frame's files, by a name, and returns their digests; in any thread, several at once. May throw.
    using Write = std::function<Json(const FrameCopy& frame, const std::string& name)>;
    /// Gets what is told of a frame, and its digests: in the order of add(), in the user's thread.
    using Written = std::function<void(Json frame, Json digests)>;

    /// One thread for each worker of the pool, which outlives this. Throws as base::start_thread().
    FrameWriters(pipeline::WorkerPool& workers, Write write, Written written);
    ~FrameWriters();  ///< finishes what is begun, and tells nothing of it
    FrameWriters(const FrameWriters&) = delete;
    FrameWriters& operator=(const FrameWriters&) = delete;

    /// Takes a copy of the frame, and waits while as many are at hand as there may be: one more than threads. Throws
    /// what writing an earlier one has thrown, or `written`; nothing can be added afterwards.
    void add(const FrameView& view, std::shared_ptr<const calibration::Rectification> rectification, std::string name,
             Json frame);

    /// Waits until all are written. Throws as add(), once nothing is written any more.
    void settle();

    /// Whether files of a frame that was added are not written, or not yet.
    bool any_left() const { return !at_hand_.empty() || failed_; }

private:
    struct Job {
        FrameCopy copy = {};
        std::string name = {};
        Json frame = {};
        Json digests = {};
        std::exception_ptr failure = {};
        bool done = false;  ///< under mutex_
    };

    void work();
    void end() noexcept;
    bool is_done(const Job& job) const;
    void collect(bool all);

    pipeline::WorkerPool& workers_;
    const Write write_;
    const Written written_;
    std::size_t most_;
    std::deque<std::unique_ptr<Job>> at_hand_ = {};  ///< in the order of add(); of the user's thread
    std::vector<std::unique_ptr<Job>> spare_ = {};   ///< likewise
    bool failed_ = false;                            ///< likewise
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Job*> waiting_ = {};  ///< for a thread
    bool ending_ = false;
    std::vector<std::thread> threads_ = {};
};

}  // namespace disparityd::tools
