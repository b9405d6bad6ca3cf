#pragma once

#include <map>
#include <vector>

#include "report/html_report.h"
#include "score.h"

/// What the proof measures, and the kinds of recordings that it is measured on.
namespace fathom::proof {

bool isRight(const Scored& s);
bool isNull(const Scored& s);
bool isEffect(const Scored& s);
bool isOutside(const Scored& s);
bool isDecoy(const Scored& s);
/// Of effects that one recording hides alone, wherever it is not hard on purpose.
bool isAlone(const Scored& s);
/// Whether nobody could tell the hidden effect from what tempts.
bool needsSet(const Scored& s);

/// Of effects of each size, as sqrt(lambda): how many answers have the truth in their set, and of how many.
std::map<double, std::pair<double, double>> foundByStratum(const std::vector<Scored>& all);

/// What the best test could find, in per cent by log2 of sqrt(lambda), that gives a false alarm in a hundred
/// recordings.
Series fisherLimit();

/// One row a measure: what was asked, what was reached, of how many.
Table measureTable(const std::vector<Scored>& all);

}  // namespace fathom::proof
