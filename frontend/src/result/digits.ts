/** Decimals that mean something: tenths of per cent and of steps per minute, hundredths of metres and seconds. */
export function digitsOf(quantity: string): number {
  return /_(percent|per_min)$/.test(quantity) ? 1 : 2;
}
