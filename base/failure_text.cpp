// SPDX-License-Identifier: Apache-2.0
#include "base/failure_text.h"

#include <new>
#include <stdexcept>

#include <opencv2/core.hpp>

namespace disparityd::base {
namespace {

constexpr const char* no_memory =
    "not enough memory: the system gives this program no more; end other programs, choose smaller images or fewer "
    "disparities, or raise the limit (ulimit -v, MemoryMax= of a service)";

}  // namespace

std::string failure_text(const std::exception& error) {
    const auto* of_opencv = dynamic_cast<const cv::Exception*>(&error);
    const bool no_more = dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
                         dynamic_cast<const std::length_error*>(&error) != nullptr ||
                         (of_opencv != nullptr && of_opencv->code == cv::Error::StsNoMem);
    if (no_more) {
        return no_memory;
    }
    return of_opencv != nullptr ? of_opencv->err : error.what();
}

std::string failure_text(const std::exception_ptr& failure) {
    try {
        std::rethrow_exception(failure);
    } catch (const std::exception& error) {
        return failure_text(error);
    } catch (...) {
        return "an unknown failure";
    }
}

}  // namespace disparityd::base
