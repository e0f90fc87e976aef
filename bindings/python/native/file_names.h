// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <pybind11/pybind11.h>

/// Names of files are bytes, of which Python makes text as os.fsdecode() does; they need not be UTF-8.
namespace disparityd::bindings {

/// Text that may hold names of files: of bytes that are no UTF-8 Python keeps what os.fsencode() makes the same bytes
/// of.
inline pybind11::str text_with_names(std::string_view text) {
    PyObject* const made = PyUnicode_DecodeFSDefaultAndSize(text.data(), static_cast<Py_ssize_t>(text.size()));
    if (made == nullptr) {
        throw pybind11::error_already_set();
    }
    return pybind11::reinterpret_steal<pybind11::str>(made);
}

/// For register_local_exception_translator(): ValueError or RuntimeError whose line may hold names of files. What else
/// is thrown is left to pybind11.
inline void translate_with_names(std::exception_ptr caught) {
    const auto raise = [](PyObject* type, const std::exception& error) {
        PyErr_SetObject(type, text_with_names(error.what()).ptr());
    };
    try {
        std::rethrow_exception(std::move(caught));
    } catch (const pybind11::error_already_set&) {
        throw;  // both are runtime errors in some versions of pybind11
    } catch (const pybind11::builtin_exception&) {
        throw;
    } catch (const std::invalid_argument& error) {
        raise(PyExc_ValueError, error);
    } catch (const std::runtime_error& error) {
        raise(PyExc_RuntimeError, error);
    }
}

}  // namespace disparityd::bindings
