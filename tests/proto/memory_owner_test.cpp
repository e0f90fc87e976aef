// SPDX-License-Identifier: Apache-2.0
//
// Whose shared memory is believed, by readers and by a daemon that meets it under its name.
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <stdexcept>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "proto/shared_memory_owner.h"
#include "tests/proto/collect.h"
#include "tests/proto/pattern.h"

namespace proto = disparityd::proto;
using namespace std::chrono_literals;
using testing::HasSubstr;

namespace {

constexpr uid_t stranger = 65534;
constexpr uid_t daemon_user = 54321;  ///< nobody's on any machine

constexpr const char* needs_root = "only root can give a file to another user";

class MemoryOwner : public testing::Test {
protected:
    std::string name_ = pattern::unique_name("owner", ::getpid());
    std::string object_ = "/disparityd." + name_;
    std::string path_ = "/dev/shm" + object_;
    proto::ShmLayout layout_ = pattern::layout(64, 32);

    void TearDown() override {
        ::unsetenv(proto::owner_variable);
        ::unlink(path_.c_str());
    }

    std::string refusal(const proto::ShmReader::Options& options = {}) {
        try {
            proto::ShmReader reader(name_, options);
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return "accepted";
    }

    /// What `call` throws in a child of that user, "nothing thrown" when nothing. `before` runs in the child as root.
    static std::string as_user(uid_t user, const std::function<void()>& call,
                               const std::function<void()>& before = {}) {
        int ends[2];
        EXPECT_EQ(::pipe(ends), 0);
        const pid_t child = ::fork();
        if (child == 0) {
            std::string said = "nothing thrown";
            try {
                if (before) {
                    before();
                }
                if (::setresuid(user, user, user) != 0) {
                    throw std::runtime_error("cannot become the user");
                }
                call();
            } catch (const std::exception& error) {
                said = error.what();
            }
            ::_exit(::write(ends[1], said.data(), said.size()) == static_cast<ssize_t>(said.size()) ? 0 : 1);
        }
        ::close(ends[1]);
        std::string said(4096, '\0');
        said.resize(static_cast<std::size_t>(std::max<ssize_t>(0, ::read(ends[0], said.data(), said.size()))));
        ::close(ends[0]);
        int status = 0;
        EXPECT_EQ(::waitpid(child, &status, 0), child);
        EXPECT_EQ(status, 0);
        return said;
    }
};

TEST_F(MemoryOwner, WhatIsTrustedIsAPlainFileOfATrustedUserThatNobodyElseCanWrite) {
    const auto only_7 = [](uid_t user) { return user == 7; };
    struct stat object {};
    object.st_uid = 7;
    for (const mode_t mode : {0640U, 0600U, 0644U, 0440U, 0755U}) {
        object.st_mode = S_IFREG | mode;
        EXPECT_EQ(proto::distrust(object, only_7), "") << mode;
    }
    object.st_mode = S_IFREG | 0666;
    EXPECT_THAT(proto::distrust(object, only_7), HasSubstr("can be written by others than its owner (mode 0666"));
    object.st_mode = S_IFREG | 0660;
    EXPECT_THAT(proto::distrust(object, only_7), HasSubstr("mode 0660"));
    object.st_mode = S_IFREG | 0602;
    EXPECT_THAT(proto::distrust(object, only_7), HasSubstr("mode 0602"));
    for (const mode_t kind : std::initializer_list<mode_t>{S_IFIFO, S_IFSOCK, S_IFDIR, S_IFCHR, S_IFLNK}) {
        object.st_mode = kind | 0640;
        EXPECT_THAT(proto::distrust(object, only_7), HasSubstr("is no plain file")) << kind;
    }
    object.st_mode = S_IFREG | 0640;
    object.st_uid = daemon_user;
    EXPECT_EQ(proto::distrust(object, only_7), "belongs to a user with uid 54321");
}

TEST_F(MemoryOwner, RootOneselfAndTheNamedUserAreTrusted) {
    EXPECT_TRUE(proto::is_trusted(0, ""));
    EXPECT_TRUE(proto::is_trusted(::geteuid(), "no such user"));
    EXPECT_TRUE(proto::is_trusted(daemon_user, "54321"));
    EXPECT_FALSE(proto::is_trusted(daemon_user, "54322"));
    EXPECT_FALSE(proto::is_trusted(daemon_user, "54321x"));
    EXPECT_FALSE(proto::is_trusted(daemon_user, ""));
    EXPECT_FALSE(proto::is_trusted(daemon_user, "root"));
    EXPECT_FALSE(proto::is_trusted(daemon_user, "-1"));
    EXPECT_FALSE(proto::is_trusted(static_cast<uid_t>(-1), "no such user"));
}

TEST_F(MemoryOwner, TheUserIsTheCallersThenTheEnvironmentsThenTheServices) {
    EXPECT_EQ(proto::trusted_user(""), "disparityd");
    ::setenv(proto::owner_variable, "alice", 1);
    EXPECT_EQ(proto::trusted_user(""), "alice");
    EXPECT_EQ(proto::trusted_user("bob"), "bob");
    ::setenv(proto::owner_variable, "", 1);
    EXPECT_EQ(proto::trusted_user(""), "disparityd");
}

TEST_F(MemoryOwner, ObjectOfAStrangerIsRefusedUntilItsOwnerIsNamed) {
    if (::geteuid() != 0) {
        GTEST_SKIP() << needs_root;
    }
    proto::SharedMemoryWriter writer(name_, layout_);
    EXPECT_EQ(refusal(), "accepted");
    ASSERT_EQ(::chown(path_.c_str(), stranger, 0), 0);
    EXPECT_THAT(refusal(), HasSubstr("shared memory " + object_ + " belongs to "));
    EXPECT_THAT(refusal(), HasSubstr("uid 65534"));
    EXPECT_THAT(refusal(), HasSubstr("name it with DISPARITYD_SHARED_MEMORY_OWNER"));
    proto::ShmReader::Options options;
    options.owner = "65534";
    EXPECT_EQ(refusal(options), "accepted");
    ::setenv(proto::owner_variable, "65534", 1);
    EXPECT_EQ(refusal(), "accepted");
}

TEST_F(MemoryOwner, ObjectThatOthersCanWriteIsRefused) {
    proto::SharedMemoryWriter writer(name_, layout_);
    for (const mode_t mode : {0666U, 0660U, 0602U}) {
        ASSERT_EQ(::chmod(path_.c_str(), mode), 0);
        EXPECT_THAT(refusal(), HasSubstr("can be written by others than its owner")) << mode;
    }
    ASSERT_EQ(::chmod(path_.c_str(), 0640), 0);
    EXPECT_EQ(refusal(), "accepted");
}

TEST_F(MemoryOwner, LinksPipesAndFoldersAreRefusedAtOnce) {
    const std::string other = pattern::unique_name("target", ::getpid());
    proto::SharedMemoryWriter target(other, layout_);
    ASSERT_EQ(::symlink(("/dev/shm/disparityd." + other).c_str(), path_.c_str()), 0);
    EXPECT_THAT(refusal(), HasSubstr("is a symbolic link"));
    ::unlink(path_.c_str());
    ASSERT_EQ(::mkfifo(path_.c_str(), 0640), 0);
    EXPECT_THAT(refusal(), HasSubstr("is no plain file"));
    {
        proto::SharedMemoryWriter writer(name_, layout_);
        EXPECT_THAT(writer.note(), HasSubstr("which was no plain file"));
        EXPECT_EQ(refusal(), "accepted");
    }
    ASSERT_EQ(::mkdir(path_.c_str(), 0750), 0);
    EXPECT_THAT(refusal(), HasSubstr("is no plain file"));
    EXPECT_THROW(proto::SharedMemoryWriter(name_, layout_), std::runtime_error);
    ::rmdir(path_.c_str());
}

// A stranger who takes the name while no daemon has it neither feeds a reader nor ends it.
TEST_F(MemoryOwner, ReaderThatWaitsForItsDaemonPassesAStrangersObjectOver) {
    if (::geteuid() != 0) {
        GTEST_SKIP() << needs_root;
    }
    auto writer = std::make_unique<proto::SharedMemoryWriter>(name_, layout_);
    proto::ShmReader reader(name_);
    Collected got;
    writer.reset();
    EXPECT_EQ(got.read(reader, 20s), proto::ShmReader::Result::gone);
    for (const mode_t mode : {0640U, 0000U}) {
        const int file = ::shm_open(object_.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
        ASSERT_GE(file, 0);
        ASSERT_EQ(::fchown(file, stranger, 0), 0);
        ASSERT_EQ(::fchmod(file, mode), 0);
        ::close(file);
        EXPECT_EQ(got.read(reader, 120ms), proto::ShmReader::Result::gone);
        EXPECT_THAT(reader.why_gone(), HasSubstr("uid 65534"));
        ::shm_unlink(object_.c_str());
    }
    proto::SharedMemoryWriter next(name_, layout_);
    pattern::Source source(layout_);
    next.publish(pattern::head(3, layout_), source.make(3));
    EXPECT_EQ(got.read(reader, 20s), proto::ShmReader::Result::frame);
}

TEST_F(MemoryOwner, DaemonNamesWhoHasTakenItsName) {
    if (::geteuid() != 0) {
        GTEST_SKIP() << needs_root;
    }
    const int file = ::shm_open(object_.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
    ASSERT_GE(file, 0);
    ASSERT_EQ(::fchown(file, stranger, 0), 0);
    ::close(file);
    for (const mode_t mode : {0600U, 0666U}) {
        ASSERT_EQ(::chmod(path_.c_str(), mode), 0);
        const std::string said = as_user(daemon_user, [this] { proto::SharedMemoryWriter writer(name_, layout_); });
        EXPECT_THAT(said, HasSubstr("shared memory " + object_ + ": the name is taken by an object of "));
        EXPECT_THAT(said, HasSubstr("uid 65534"));
        EXPECT_THAT(said, HasSubstr("remove " + path_));
        EXPECT_THAT(said, HasSubstr("[shared_memory] name"));
    }
    // Root may take the name.
    proto::SharedMemoryWriter writer(name_, layout_);
    EXPECT_THAT(writer.note(), HasSubstr("uid 65534"));
    EXPECT_EQ(refusal(), "accepted");
}

TEST_F(MemoryOwner, TemporaryNameCannotBeTakenBeforehand) {
    if (::geteuid() != 0) {
        GTEST_SKIP() << needs_root;
    }
    // What anybody can work out beforehand; the daemon's user may not remove it.
    const auto guess = [this] { return object_ + "." + std::to_string(::getpid()) + ".new"; };
    const auto take = [&guess] {
        if (::shm_open(guess().c_str(), O_RDWR | O_CREAT | O_EXCL, 0600) < 0) {
            throw std::runtime_error("the guessed name cannot be taken");
        }
    };
    const std::string said = as_user(
        daemon_user, [this] { proto::SharedMemoryWriter writer(name_, layout_); }, take);
    EXPECT_EQ(said, "nothing thrown");
    for (const auto& entry : std::filesystem::directory_iterator("/dev/shm")) {
        if (entry.path().string().starts_with(path_ + ".")) {
            std::filesystem::remove(entry.path());
        }
    }
}

}  // namespace
