// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "proto/shared_memory_layout.h"

namespace disparityd::proto {

/// A client's side of shared memory: maps /disparityd.<name> read-only, waits for frames and copies them out whole.
/// The writer never notices a reader. One thread at a time per object.
class ShmReader {
public:
    struct Options {
        std::chrono::nanoseconds stale_after = std::chrono::seconds(3);  ///< older heartbeat = the daemon is dead
        std::chrono::nanoseconds check_every = std::chrono::milliseconds(500);  ///< that is looked at while waiting
    };
    enum class Result { frame, timeout, gone };

    /// Says where the bytes of a plane go (plane.bytes of them), or nullptr to leave the plane out. Called for every
    /// plane of the object, and again when the writer overtook the copy.
    using Target = std::function<std::uint8_t*(const ShmPlane& plane)>;

    /// Throws std::invalid_argument for a name that is not allowed, std::runtime_error with one line when there is no
    /// such object, access is denied or its header cannot be trusted.
    explicit ShmReader(const std::string& name) : ShmReader(name, Options{}) {}
    ShmReader(const std::string& name, const Options& options);
    ~ShmReader();
    ShmReader(const ShmReader&) = delete;
    ShmReader& operator=(const ShmReader&) = delete;

    /// Copies the newest frame not read before, waiting for one at most so long. `gone`: the daemon has closed its
    /// object or its heartbeat is old; the next call looks for a new object under the same name, and so does this one
    /// after a reload. Throws as the constructor does when such a new object cannot be used.
    Result read(ShmFrame& frame, const Target& target, std::chrono::nanoseconds timeout);

    /// Size of image and planes of the object mapped now; changes only inside read().
    const ShmView& view() const { return view_; }

    /// Since the daemon's last sign of life; the largest value when nothing is mapped.
    std::chrono::nanoseconds heartbeat_age() const;

private:
    enum class Copy { done, nothing_new, torn };

    /// Maps what has the name now, if that is another object than ours; false = none, or a closed one.
    bool map_current();
    void unmap();
    bool lives() const;
    Copy copy_newest(ShmFrame& frame, const Target& target);

    std::string object_name_;
    Options options_;
    const ShmHeader* header_ = nullptr;
    std::uint64_t mapped_bytes_ = 0;
    std::uint64_t inode_ = 0;
    std::uint32_t generation_ = 0;
    std::uint64_t last_total_ = 0;
    ShmView view_;
};

}  // namespace disparityd::proto
