// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <sys/types.h>

#include "proto/mapping.h"
#include "proto/sequence_lock.h"
#include "proto/shared_memory_layout.h"

namespace disparityd::proto {

/// The slot of a frame that is looked at where it lies.
struct BorrowedSlot {
    std::shared_ptr<const Mapping> memory;  ///< stays mapped as long as this does
    ShmView view;                           ///< of that memory
    const ShmSlot* slot = nullptr;
    std::optional<ReadCheck> check;  ///< begun before the frame was looked at

    /// Returns whether all that was read from the slot until now belongs to the frame.
    bool whole() const { return check && check->unchanged(); }
};

/// Reads shared memory for a client: maps /disparityd.<name> read-only, waits for frames and copies them out whole, or
/// says where they lie. A reader writes nothing; one that waits costs the writer its waking up. One thread at a time
/// per object.
class ShmReader {
public:
    struct Options {
        std::chrono::nanoseconds stale_after = std::chrono::seconds(3);         ///< an older heartbeat counts as `gone`
        std::chrono::nanoseconds check_every = std::chrono::milliseconds(500);  ///< between two looks at the heartbeat
        std::chrono::nanoseconds look_every = std::chrono::milliseconds(50);    ///< for a new object after `gone`
        bool may_be_absent = false;  ///< no error at construction when there is no daemon yet
        std::string owner;           ///< the user who is trusted too: trusted_user()
    };
    enum class Result { frame, timeout, gone };

    /// Returns where the plane.bytes bytes of a plane go, or nullptr to leave the plane out. read() calls it for every
    /// plane of the object, and again when the writer overtook the copy.
    using Target = std::function<std::uint8_t*(const ShmPlane& plane)>;

    /// Throws std::invalid_argument for a name that is not allowed, std::runtime_error with one line when the object's
    /// header is damaged or of another version, and, unless it may be absent, when there is none, access is denied or
    /// it is somebody's who is not trusted (shared_memory_owner.h).
    explicit ShmReader(const std::string& name) : ShmReader(name, Options{}) {}
    ShmReader(const std::string& name, const Options& options);
    ~ShmReader();
    ShmReader(const ShmReader&) = delete;
    ShmReader& operator=(const ShmReader&) = delete;

    /// Copies the newest frame not read before, and waits for one until the timeout. After a reload it maps the new
    /// object. Returns `gone` at once when the daemon has closed its object or its heartbeat is old. The calls after it
    /// wait for a new daemon, and return `gone` again when none has come in time. An object of an owner who is not
    /// trusted counts as none. frame.age_ns counts until this call returns: the first frame may be an old one. Throws
    /// std::runtime_error when a new object is damaged or of another version.
    Result read(FrameInfo& frame, const Target& target, std::chrono::nanoseconds timeout);

    /// The same, but only `frame` is copied; `slot` then says where the planes lie.
    Result borrow(FrameInfo& frame, BorrowedSlot& slot, std::chrono::nanoseconds timeout);

    /// Returns the sizes of image and planes of the object mapped now. They change only inside read().
    const ShmView& view() const { return view_; }

    /// Returns one line: why the last read() was `gone`, or why there was no daemon at construction.
    const std::string& why_gone() const { return why_gone_; }

    /// Returns how long the frame taken last had been published then: the last part of its age.
    std::int64_t waited_ns() const { return waited_ns_; }

    /// Returns the time since the daemon's last heartbeat; the largest value when nothing is mapped.
    std::chrono::nanoseconds heartbeat_age() const;

private:
    enum class Taken { whole, nothing_new, torn };
    /// Takes what is wanted from a slot while the check holds.
    using Take = std::function<void(const ShmSlot& slot, const ReadCheck& check)>;

    /// Maps the object that has the name now, if it is another one. Returns false when there is none that is open and
    /// trusted; why_gone_ then has the reason.
    bool map_current();
    bool no_daemon(const std::string& why);
    bool may_look_again(std::int64_t deadline);
    void unmap();
    bool lives() const;
    Taken take_newest(const Take& take);
    void copy_fields(FrameInfo& frame, const ShmSlot& slot);
    void count_age(FrameInfo& frame);
    Result wait_and_take(const Take& take, std::chrono::nanoseconds timeout);

    std::string object_name_;
    Options options_;
    std::unique_ptr<const Descriptor> file_;  ///< of memory_; holds the lock of a reader
    std::shared_ptr<const Mapping> memory_;
    const ShmHeader* header_ = nullptr;  ///< the start of memory_
    dev_t device_ = 0;
    ino_t inode_ = 0;
    std::uint32_t generation_ = 0;
    std::uint64_t last_total_ = 0;
    std::int64_t published_ns_ = 0;  ///< of the frame taken last
    std::int64_t waited_ns_ = 0;
    ShmView view_;
    std::string why_gone_;
    bool gone_told_ = false;
};

}  // namespace disparityd::proto
