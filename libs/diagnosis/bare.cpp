#include "diagnosis/bare.h"

#include <utility>

#include "effects/catalogue.h"
#include "estimation/sparse.h"

namespace fathom {
namespace {

Eigen::VectorXd valuesOf(const Linearization& linear, const std::vector<Candidate>& effects,
                         const BatchState& state) {
  std::vector<double> values;
  for (const Candidate& effect : effects)
    for (const CandidateColumn& c : columnsOf(linear, effect.effect)) {
      const std::size_t scalar = linear.columns[c.column].scalar;
      values.push_back(c.image < 0 ? sizeOf(scalar, state.effects.values[scalar])
                                   : state.drawn({scalar, static_cast<std::size_t>(c.image)}));
    }
  return Eigen::Map<Eigen::VectorXd>(values.data(), std::ssize(values));
}

bool isOfEffect(const Linearization& linear, const UnknownBlock& block) {
  return block.kind == UnknownBlock::Kind::effect ||
         (block.kind == UnknownBlock::Kind::draw &&
          isEstimated(linear, effectOf(linear.draws[block.index].scalar)));
}

/// What holds an effect's unknowns alone says nothing where they are none.
void clearEmptyPriors(const Linearization& linear, Bare& bare) {
  std::vector<bool> is_empty(linear.rows.size(), true);
  for (Eigen::Index c = 0; c < bare.J.outerSize(); ++c)
    for (Eigen::SparseMatrix<double>::InnerIterator e(bare.J, c); e; ++e)
      is_empty[static_cast<std::size_t>(e.row())] = false;
  for (std::size_t i = 0; i < linear.rows.size(); ++i)
    if (linear.rows[i].channel == kChannel<Prior> && is_empty[i])
      bare.residual[static_cast<Eigen::Index>(i)] = 0;
}

}  // namespace

Bare bareOf(const Linearization& linear, const std::vector<Candidate>& effects, const BatchState& state) {
  Bare bare;
  std::vector<Eigen::Index> kept;
  for (UnknownBlock block : linear.blocks) {
    if (isOfEffect(linear, block)) continue;
    const auto first = static_cast<int>(std::ssize(kept));
    for (int k = 0; k < block.size; ++k) kept.push_back(block.column + k);
    block.column = first;
    bare.blocks.push_back(block);
  }
  bare.J = columnsOf(linear.J, kept);
  if (linear.taken.nonZeros() > 0) bare.taken = columnsOf(linear.taken, kept);
  bare.unknowns = std::move(kept);
  bare.through = {bare.J, bare.taken, bare.blocks};
  bare.columns = bare.through.of(columnsOf(linear, effects));
  bare.values = valuesOf(linear, effects, state);
  bare.residual = linear.residual - bare.columns * bare.values;
  clearEmptyPriors(linear, bare);
  return bare;
}

Linearization withoutEffects(Linearization linear, Bare bare) {
  linear.residual = std::move(bare.residual);
  linear.J.swap(bare.J);  // this Eigen moves no sparse matrix
  linear.taken.swap(bare.taken);
  linear.blocks = std::move(bare.blocks);
  for (EffectColumn& column : linear.columns) column.estimated = false;
  return linear;
}

}  // namespace fathom
