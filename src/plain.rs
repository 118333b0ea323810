//! Matrices and vectors as hosts have them: the border takes plain arrays, and glam's types where the host's glam is
//! [`antumbra::glam`](crate::glam).

use glam::{DMat4, DVec3, Mat4, Vec3};

/// A 4×4 matrix for column vectors, made from arrays in column-major order (16 numbers, or 4 columns), of 32 or 64
/// bits.
///
/// ```
/// use antumbra::Matrix;
/// # let row_major = [[1.0, 0.0, 0.0, 5.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0f32]];
/// let columns = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [5.0, 0.0, 0.0, 1.0f32]];
/// assert_eq!(Matrix::from(columns), Matrix::from(row_major).transposed());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrix(pub DMat4);

impl Matrix {
    /// The matrix with rows and columns exchanged: what an array in row-major order holds.
    #[must_use]
    pub fn transposed(self) -> Self {
        Self(self.0.transpose())
    }

    /// The inverse; not finite where the matrix has none, which planning refuses.
    #[must_use]
    pub fn inverse(self) -> Self {
        Self(self.0.inverse())
    }
}

impl From<DMat4> for Matrix {
    fn from(matrix: DMat4) -> Self {
        Self(matrix)
    }
}

impl From<Mat4> for Matrix {
    fn from(matrix: Mat4) -> Self {
        Self(matrix.as_dmat4())
    }
}

impl From<[f64; 16]> for Matrix {
    fn from(columns: [f64; 16]) -> Self {
        Self(DMat4::from_cols_array(&columns))
    }
}

impl From<[f32; 16]> for Matrix {
    fn from(columns: [f32; 16]) -> Self {
        columns.map(f64::from).into()
    }
}

impl From<[[f64; 4]; 4]> for Matrix {
    fn from(columns: [[f64; 4]; 4]) -> Self {
        Self(DMat4::from_cols_array_2d(&columns))
    }
}

impl From<[[f32; 4]; 4]> for Matrix {
    fn from(columns: [[f32; 4]; 4]) -> Self {
        columns.map(|column| column.map(f64::from)).into()
    }
}

impl From<Matrix> for DMat4 {
    fn from(matrix: Matrix) -> Self {
        matrix.0
    }
}

/// A position or a direction, made from three numbers of 32 or 64 bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector(pub DVec3);

impl From<DVec3> for Vector {
    fn from(vector: DVec3) -> Self {
        Self(vector)
    }
}

impl From<Vec3> for Vector {
    fn from(vector: Vec3) -> Self {
        Self(vector.as_dvec3())
    }
}

impl From<[f64; 3]> for Vector {
    fn from(numbers: [f64; 3]) -> Self {
        Self(DVec3::from_array(numbers))
    }
}

impl From<[f32; 3]> for Vector {
    fn from(numbers: [f32; 3]) -> Self {
        numbers.map(f64::from).into()
    }
}

impl From<Vector> for DVec3 {
    fn from(vector: Vector) -> Self {
        vector.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RectangleLight;

    #[test]
    fn every_form_of_a_matrix_is_the_same_matrix() {
        let wanted = Matrix(DMat4::from_cols_array(&std::array::from_fn(|i| i as f64)));
        let columns: [[f64; 4]; 4] =
            std::array::from_fn(|c| std::array::from_fn(|r| (4 * c + r) as f64));
        let single: [f32; 16] = std::array::from_fn(|i| i as f32);
        assert_eq!(Matrix::from(single), wanted);
        assert_eq!(Matrix::from(single.map(f64::from)), wanted);
        assert_eq!(Matrix::from(columns), wanted);
        assert_eq!(Matrix::from(columns.map(|column| column.map(|x| x as f32))), wanted);
        assert_eq!(Matrix::from(Mat4::from_cols_array(&single)), wanted);
        assert_eq!(wanted.0.col(3).to_array(), columns[3], "columns, not rows");
    }

    #[test]
    fn every_form_of_a_vector_makes_the_same_light() {
        let wanted = RectangleLight::new(DVec3::Y, DVec3::X, DVec3::NEG_Z).unwrap();
        let doubles = RectangleLight::new([0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]);
        assert_eq!(doubles.unwrap(), wanted);
        let singles = RectangleLight::new([0.0, 1.0, 0.0f32], Vec3::X, [0.0, 0.0, -1.0f32]);
        assert_eq!(singles.unwrap(), wanted);
    }
}
