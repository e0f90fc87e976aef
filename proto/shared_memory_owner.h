// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include <sys/stat.h>
#include <sys/types.h>

/// Decides whose shared memory a reader uses. Any user of a machine can create an object under a free name. The owner
/// can write any frame into it, and can shrink it, which ends every program that has it mapped (SIGBUS). See
/// docs/design/shared-memory.md.
namespace disparityd::proto {

/// The user that the service runs as.
inline constexpr const char* service_user = "disparityd";

/// The environment variable that names another user than service_user.
inline constexpr const char* owner_variable = "DISPARITYD_SHARED_MEMORY_OWNER";

/// Returns the user who is trusted beside root and this process's own: `named`, else the one in owner_variable (not for
/// a set-uid program), else service_user.
std::string trusted_user(const std::string& named);

/// Whether `owner` is root, this process's own user or `user`: a name, or a number where the name is not known, as in a
/// container. Looks names up only when it has to.
bool is_trusted(uid_t owner, const std::string& user);

/// Returns why an object must not be used, as the end of a sentence about it; empty when it may. It must be a plain
/// file whose owner `trusted` accepts and which nobody else can write.
std::string distrust(const struct stat& object, const std::function<bool(uid_t)>& trusted);

/// Returns a user for messages: "user nobody (uid 65534)".
std::string user_text(uid_t uid);

}  // namespace disparityd::proto
