// SPDX-License-Identifier: Apache-2.0
// Put in front of the reference's sources when they are compiled a second time: the same functions in another
// namespace. The standard headers come first, so that only the project's own namespace is renamed.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#define reference reference_not_vectorised
