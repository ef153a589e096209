// Weights of Nystrom's method of order 5 (Nystrom 1925; Hairer, Norsett & Wanner, Solving ODEs I, II.14): of y at its
// first three nodes 0, 1/5, 2/3 (the fourth's, 1, is 0), and of y' at all four.

const B1: f32 = 1.0 / 24.0;
const B2: f32 = 25.0 / 84.0;
const B3: f32 = 9.0 / 56.0;
const D1: f32 = 1.0 / 24.0;
const D2: f32 = 125.0 / 336.0;
const D3: f32 = 27.0 / 56.0;
const D4: f32 = 5.0 / 48.0;
