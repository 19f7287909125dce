// Where a definition that needs no template is compiled, and for which processor.
//
// A header `x.hpp` declares; beside it `x.cpp` defines, or in text/ to solve/ `x.ipp`, each function
// marked KINECAL_INLINE.  The libraries compile each once.  With KINECAL_HEADER_ONLY defined, every source
// compiles what it includes of text/ to solve/, and needs libraries only for the other folders.
//
// What is evaluated in packets differs between instruction sets, in width and in alignment.  So
// packets live in an inline namespace that bears the name of the instruction set, and every source
// refers to a constant in it that the library defines for its own: a source that is compiled with
// other flags, such as -mavx2, does not link (instead of crashing where the two meet).  Eigen's alignment
// has a constant of its own (geometry/eigen_layout.hpp).
// Source: x86-64 psABI, micro-architecture levels.
// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Before each definition in an .ipp file: `inline` with KINECAL_HEADER_ONLY, else nothing.
#ifdef KINECAL_HEADER_ONLY
#define KINECAL_INLINE inline
#else
#define KINECAL_INLINE
#endif

/// \def KINECAL_INSTRUCTION_SET
/// Name of the inline namespace of packets: the instruction set that this source is compiled for.
/// \def KINECAL_X86_64_LEVEL
/// Highest x86-64 level whose instructions this source may use, as text; "other" elsewhere.
#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512CD__) && \
    defined(__AVX512DQ__) && defined(__AVX512VL__)
#define KINECAL_INSTRUCTION_SET x86_64_v4
#define KINECAL_X86_64_LEVEL "x86-64-v4"
#elif defined(__AVX512F__)
#define KINECAL_INSTRUCTION_SET x86_64_avx512f
#define KINECAL_X86_64_LEVEL "x86-64-v3"
#elif defined(__AVX2__) && defined(__FMA__) && defined(__BMI2__) && defined(__F16C__)
#define KINECAL_INSTRUCTION_SET x86_64_v3
#define KINECAL_X86_64_LEVEL "x86-64-v3"
#elif defined(__AVX__)
#define KINECAL_INSTRUCTION_SET x86_64_avx
#define KINECAL_X86_64_LEVEL "x86-64"
#elif defined(__x86_64__)
#define KINECAL_INSTRUCTION_SET x86_64
#define KINECAL_X86_64_LEVEL "x86-64"
#else
#define KINECAL_INSTRUCTION_SET other
#define KINECAL_X86_64_LEVEL "other"
#endif

// Eigen allocates differently with g++'s address sanitizer, so these do not mix either.
#ifdef __SANITIZE_ADDRESS__
#define KINECAL_LIBRARY_CHECK kLibraryIsCompiledForThisWithAddressSanitizer
#else
#define KINECAL_LIBRARY_CHECK kLibraryIsCompiledForThis  ///< a symbol of this name
#endif

#ifndef KINECAL_HEADER_ONLY
namespace kinecal {

inline namespace KINECAL_INSTRUCTION_SET {
/// Defined by the library for the flags that it is compiled with, and for no others.
extern const bool KINECAL_LIBRARY_CHECK;
}  // namespace KINECAL_INSTRUCTION_SET

namespace detail {
[[gnu::used]] static const bool* const kLibraryCheck = &KINECAL_LIBRARY_CHECK;
}  // namespace detail

}  // namespace kinecal
#endif
