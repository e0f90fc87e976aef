// SPDX-License-Identifier: Apache-2.0
#include "proto/shared_memory_reader.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "proto/futex.h"
#include "proto/mapping.h"
#include "proto/monotonic_clock.h"
#include "proto/reader_lock.h"
#include "proto/sequence_lock.h"
#include "proto/shared_memory_owner.h"

namespace disparityd::proto {
namespace {

/// A frame that the writer overtook is tried again at once; only this often when the time is up already.
constexpr int attempts_beyond_timeout = 8;

std::string reason_to_open(int error) {
    if (error == ENOENT) {
        return "there is none: is disparityd running, with shared memory on and this name?";
    }
    if (error == EACCES) {
        return "access denied: join the daemon's group, or run as its user";
    }
    if (error == ELOOP) {
        return "is a symbolic link: nothing that disparityd made";
    }
    return std::string("cannot be opened: ") + std::strerror(error);
}

}  // namespace

ShmReader::ShmReader(const std::string& name, const Options& options)
    : object_name_(shm_object_name(name)), options_(options) {
    options_.owner = trusted_user(options.owner);
    if (!map_current()) {
        if (!options.may_be_absent) {
            throw std::runtime_error(why_gone_);
        }
        gone_told_ = true;
    }
}

ShmReader::~ShmReader() = default;

void ShmReader::unmap() {
    file_.reset();
    memory_.reset();
    header_ = nullptr;
}

bool ShmReader::no_daemon(const std::string& why) {
    why_gone_ = "shared memory " + object_name_ + why;
    return false;
}

bool ShmReader::map_current() {
    // Any user may have put anything under the name: the call follows no link and does not wait for a pipe.
    auto file = std::make_unique<const Descriptor>(
        ::shm_open(object_name_.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK, 0));
    struct stat info {};
    if (file->get() < 0 || ::fstat(file->get(), &info) != 0) {
        return no_daemon(": " + reason_to_open(errno));
    }
    // Two objects that exist at the same time never share an inode number, and ours exists as long as it is mapped.
    if (header_ != nullptr && info.st_ino == inode_ && info.st_dev == device_) {
        return header_->generation.load(std::memory_order_acquire) == generation_ ||
               no_daemon(": the daemon has closed it");
    }
    const auto trusted = [this](uid_t owner) { return is_trusted(owner, options_.owner); };
    if (const std::string why = distrust(info, trusted); !why.empty()) {
        return no_daemon(" " + why + ", allowed: a plain file of root, of this program's user or of " + options_.owner +
                         "; if the daemon runs as another user, name it with " + owner_variable);
    }
    // From here on only a trusted user can make the object smaller.
    const auto bytes = static_cast<std::uint64_t>(info.st_size);
    if (bytes < sizeof(ShmHeader)) {
        throw std::runtime_error("shared memory " + object_name_ + " has " + std::to_string(bytes) +
                                 " bytes, its header alone has " + std::to_string(sizeof(ShmHeader)));
    }
    const auto memory = std::make_shared<const Mapping>(*file, bytes, PROT_READ);
    if (!*memory) {
        throw std::runtime_error("shared memory " + object_name_ + ": cannot be mapped: " + std::strerror(errno));
    }
    const auto& header = memory->start<const ShmHeader>();
    ShmView view;
    if (const std::string wrong = check_header(header, bytes, view); !wrong.empty()) {
        throw std::runtime_error("shared memory " + object_name_ + " " + wrong);
    }
    const std::uint32_t generation = header.generation.load(std::memory_order_acquire);
    if (generation == 0) {
        return no_daemon(": the daemon has closed it");
    }
    hold_reader_lock(*file);
    file_ = std::move(file);
    memory_ = memory;
    header_ = &header;
    device_ = info.st_dev;
    inode_ = info.st_ino;
    generation_ = generation;
    last_total_ = 0;
    view_ = view;
    return true;
}

/// Sleeps until the next look for a daemon. Returns false when read() must return `gone`: at once the first time, and
/// at the deadline after that.
bool ShmReader::may_look_again(std::int64_t deadline) {
    const std::chrono::nanoseconds left(deadline - monotonic_ns());
    if (!gone_told_ || left.count() <= 0) {
        gone_told_ = true;
        return false;
    }
    std::this_thread::sleep_for(std::min(left, options_.look_every));
    return true;
}

std::chrono::nanoseconds ShmReader::heartbeat_age() const {
    if (header_ == nullptr) {
        return std::chrono::nanoseconds::max();
    }
    // The memory may hold any value: a difference that overflows counts as the largest age.
    std::int64_t age = 0;
    if (__builtin_sub_overflow(monotonic_ns(), header_->heartbeat_ns.load(std::memory_order_acquire), &age)) {
        age = std::numeric_limits<std::int64_t>::max();
    }
    return std::chrono::nanoseconds(std::max<std::int64_t>(age, 0));
}

bool ShmReader::lives() const {
    return header_ != nullptr && header_->generation.load(std::memory_order_acquire) == generation_;
}

ShmReader::Taken ShmReader::take_newest(const Take& take) {
    const std::uint64_t total = header_->published_total.load(std::memory_order_acquire);
    if (total == last_total_ || total <= header_->outdated_total.load(std::memory_order_acquire)) {
        return Taken::nothing_new;
    }
    const ShmSlot& slot = slot_at(*header_, view_, (total - 1) % view_.slot_count);
    const ReadCheck check(slot.lock);
    if (check.writer_inside()) {
        return Taken::torn;
    }
    take(slot, check);
    if (!check.unchanged()) {
        return Taken::torn;
    }
    last_total_ = total;
    return Taken::whole;
}

/// Copies the fields of a frame.
void ShmReader::copy_fields(FrameInfo& frame, const ShmSlot& slot) {
    copy_from_shared(&frame, reinterpret_cast<const std::uint64_t*>(&slot.frame), sizeof frame);
    published_ns_ = static_cast<std::int64_t>(load_word(&slot.published_ns));
}

/// Lets the age of a frame that was taken end now. The memory may hold any value: an age that overflows stays as it is.
void ShmReader::count_age(FrameInfo& frame) {
    waited_ns_ = 0;
    std::int64_t since = 0;
    std::int64_t age = 0;
    if (published_ns_ != 0 && !__builtin_sub_overflow(monotonic_ns(), published_ns_, &since) && since >= 0 &&
        !__builtin_add_overflow(frame.age_ns, since, &age)) {
        frame.age_ns = age;
        waited_ns_ = since;
    }
}

ShmReader::Result ShmReader::read(FrameInfo& frame, const Target& target, std::chrono::nanoseconds timeout) {
    const Take copy = [&](const ShmSlot& slot, const ReadCheck&) {
        copy_fields(frame, slot);
        for (std::uint32_t i = 0; i < view_.plane_count; ++i) {
            if (std::uint8_t* to = target(view_.planes[i]); to != nullptr) {
                copy_from_shared(to, plane_words(slot, view_, view_.planes[i]), view_.planes[i].bytes);
            }
        }
    };
    const Result result = wait_and_take(copy, timeout);
    if (result == Result::frame) {
        count_age(frame);
    }
    return result;
}

ShmReader::Result ShmReader::borrow(FrameInfo& frame, BorrowedSlot& borrowed, std::chrono::nanoseconds timeout) {
    borrowed = {};
    const Take look = [&](const ShmSlot& slot, const ReadCheck& check) {
        copy_fields(frame, slot);
        borrowed = {memory_, view_, &slot, check};
    };
    const Result result = wait_and_take(look, timeout);
    if (result == Result::frame) {
        count_age(frame);
    } else {
        borrowed = {};
    }
    return result;
}

ShmReader::Result ShmReader::wait_and_take(const Take& take, std::chrono::nanoseconds timeout) {
    // A year: longer than any use, and short enough that sums cannot overflow.
    const auto longest = std::chrono::nanoseconds(std::chrono::hours(24 * 365));
    const std::int64_t deadline = monotonic_ns() + std::clamp(timeout, std::chrono::nanoseconds(0), longest).count();
    int attempts = 0;
    while (true) {
        if (!lives() && !map_current()) {
            unmap();
            if (!may_look_again(deadline)) {
                return Result::gone;
            }
            continue;
        }
        const std::uint32_t seen = header_->published.load(std::memory_order_acquire);
        const Taken taken = take_newest(take);
        if (taken == Taken::whole) {
            gone_told_ = false;
            return Result::frame;
        }
        const std::int64_t now = monotonic_ns();
        if (taken == Taken::torn) {
            if (now >= deadline && ++attempts >= attempts_beyond_timeout) {
                return Result::timeout;
            }
            continue;
        }
        if (heartbeat_age() > options_.stale_after) {
            const ShmHeader* const before = header_;
            if (!map_current() || header_ == before) {
                no_daemon(": the daemon has sent no heartbeat for " +
                          std::to_string(std::chrono::duration_cast<std::chrono::seconds>(heartbeat_age()).count()) +
                          " s");
                if (!may_look_again(deadline)) {
                    return Result::gone;
                }
            }
            continue;
        }
        gone_told_ = false;
        if (now >= deadline) {
            return Result::timeout;
        }
        if (lives()) {
            futex_wait(header_->published, seen,
                       std::min(std::chrono::nanoseconds(deadline - now), options_.check_every));
        }
    }
}

}  // namespace disparityd::proto
