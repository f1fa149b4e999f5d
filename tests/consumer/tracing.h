// What a program does with the tracer and the acquisition, each part answering whether it was
// right.
#pragma once

/// Traces one view and one light of a level checker, both of whose materials are the same.
bool trace_flat_checker();

/// Evaluates a material for sixteen lights at once, which go through inline functions.
bool evaluate_lanes();
